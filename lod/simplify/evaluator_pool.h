#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "simplify/removal_evaluator.h"

namespace lodestone::detail {

/// Evaluators for as many threads as ask, and what they share.
class EvaluatorPool {
 public:
  /// Both outlive the object.
  EvaluatorPool(const SimplifyState& state, const SimplifyOptions& options)
      : state_(&state), options_(&options), attributes_(state.mesh, options.weights), rules_(state.mesh) {}

  /// Calls `job(evaluator, i)` for every i below `count`, `chunk` of them at a time with one evaluator; `progress` is
  /// of all together. Once it is cancelled no more are called.
  void for_each(std::size_t count, std::size_t chunk, const Progress& progress,
                const std::function<void(RemovalEvaluator&, std::size_t)>& job);

  /// Frees all evaluators. Pre: no evaluation is under way, as below.
  void stop() { idle_.clear(); }
  /// See FaceRules. Pre: no evaluation is under way.
  bool relax_angles(bool beyond) { return rules_.relax_angles(beyond); }

 private:
  std::unique_ptr<RemovalEvaluator> take();
  void give_back(std::unique_ptr<RemovalEvaluator> evaluator);

  const SimplifyState* state_;
  const SimplifyOptions* options_;
  AttributeCost attributes_;
  FaceRules rules_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<RemovalEvaluator>> idle_;
};

}  // namespace lodestone::detail
