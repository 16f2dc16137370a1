#include "simplify/evaluator_pool.h"

#include <utility>

#include <lodestone/core/parallel.h>

namespace lodestone::detail {

void EvaluatorPool::for_each(std::size_t count, std::size_t chunk, const Progress& progress,
                             const std::function<void(RemovalEvaluator&, std::size_t)>& job) {
  for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
    if (progress.is_cancelled()) return;
    std::unique_ptr<RemovalEvaluator> evaluator = take();
    for (std::size_t i = begin; i < end; ++i) job(*evaluator, i);
    give_back(std::move(evaluator));
    progress.add(static_cast<double>(end - begin) / static_cast<double>(count));
  });
}

std::unique_ptr<RemovalEvaluator> EvaluatorPool::take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<RemovalEvaluator> evaluator = std::move(idle_.back());
      idle_.pop_back();
      return evaluator;
    }
  }
  return std::make_unique<RemovalEvaluator>(*state_, *options_, attributes_, rules_);
}

void EvaluatorPool::give_back(std::unique_ptr<RemovalEvaluator> evaluator) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(evaluator));
}

}  // namespace lodestone::detail
