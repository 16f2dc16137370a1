#include <lodestone/core/parallel.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

namespace lodestone {
namespace {

/// The exception of the lowest job that threw. oneTBB would carry the first in time, another one each run.
class FirstFailure {
 public:
  /// Runs a job unless a lower one has failed.
  template <class Job>
  void run(std::size_t index, const Job& job) {
    if (index > lowest_.load(std::memory_order_relaxed)) return;
    try {
      job(index);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (index > lowest_.load(std::memory_order_relaxed)) return;
      lowest_.store(index, std::memory_order_relaxed);
      exception_ = std::current_exception();
    }
  }

  void rethrow() const {
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  std::atomic<std::size_t> lowest_{std::numeric_limits<std::size_t>::max()};
  std::mutex mutex_;
  std::exception_ptr exception_;
};

/// Throws std::bad_alloc where memory is about to end: if it does while oneTBB sets itself up, 2022.1 waits for a lock
/// that it holds itself, without end.
void check_memory() {
  constexpr std::size_t kSetupBytes = 8 << 20;
  void* volatile block = ::operator new(kSetupBytes);  // volatile: not to be optimised away
  ::operator delete(block);
}

}  // namespace

void with_threads(std::size_t thread_count, const std::function<void()>& work) {
  check_memory();
  const int available = tbb::this_task_arena::max_concurrency();
  const auto wanted = std::min(thread_count, static_cast<std::size_t>(available));
  tbb::task_arena arena(thread_count == 0 ? available : static_cast<int>(wanted));
  arena.execute(work);
}

void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
  if (count <= 1) {  // nothing to share
    if (count == 1) job(0);
    return;
  }
  check_memory();
  FirstFailure failure;
  // Who waits for the last jobs of a loop begins nothing else: that may take much longer than they do.
  tbb::this_task_arena::isolate([&] {
    // Jobs are large and of any length: each is a task of its own.
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) failure.run(i, job);
        },
        tbb::simple_partitioner());
  });
  failure.rethrow();
}

void for_each_chunk(std::size_t count, std::size_t chunk_size,
                    const std::function<void(std::size_t begin, std::size_t end)>& job) {
  for_each_in_parallel((count + chunk_size - 1) / chunk_size, [&](std::size_t chunk) {
    const std::size_t begin = chunk * chunk_size;
    job(begin, std::min(begin + chunk_size, count));
  });
}

/// Worked on by one thread at a time: the owner, or one that it calls.
struct SideJobs::Queue {
  /// Has another thread come, unless one is at work or on its way.
  void call() {
    {
      const std::lock_guard lock(mutex);
      if (is_called || is_worked_on || waiting.empty()) return;
      check_memory();
      is_called = true;
    }
    // What is called has to come, if only to find nothing left: oneTBB frees no task that waits when the program ends.
    called.run([this] {
      {
        const std::lock_guard lock(mutex);
        is_called = false;
      }
      work(0);
    });
  }

  /// Does jobs until so many are left, unless another thread is on them.
  void work(std::size_t most_left) {
    std::unique_lock lock(mutex);
    if (is_worked_on) return;
    is_worked_on = true;
    for (; waiting.size() > most_left; ended.notify_all()) {
      std::function<void()> job = std::exchange(waiting.front(), nullptr);
      lock.unlock();
      run(job);
      job = nullptr;  // frees what it holds
      lock.lock();
      waiting.pop_front();
    }
    is_worked_on = false;
    ended.notify_all();
  }

  void wait(std::size_t most_left) {
    work(most_left);
    std::unique_lock lock(mutex);
    ended.wait(lock, [&] { return waiting.size() <= most_left; });
    if (failure && waiting.empty()) std::rethrow_exception(std::exchange(failure, nullptr));
  }

  std::mutex mutex;
  std::deque<std::function<void()>> waiting;  // the first one may be on the way
  tbb::task_group called;                     // one task at most

 private:
  void run(const std::function<void()>& job) {
    if (failure) return;
    try {
      job();
    } catch (...) {
      failure = std::current_exception();
    }
  }

  std::condition_variable ended;  // a job, or the work on them
  bool is_called = false;         // and has not come yet
  bool is_worked_on = false;
  std::exception_ptr failure;
};

SideJobs::SideJobs() : queue_(std::make_unique<Queue>()) {}

void SideJobs::add(std::function<void()> job) {
  {
    const std::lock_guard lock(queue_->mutex);
    queue_->waiting.push_back(std::move(job));
  }
  call_for_work();
}

void SideJobs::call_for_work() {
  if (tbb::this_task_arena::max_concurrency() == 1)
    queue_->work(0);
  else
    queue_->call();
}

void SideJobs::wait(std::size_t most_left) {
  queue_->wait(most_left);
  call_for_work();
}

SideJobs::~SideJobs() {
  try {
    wait();
  } catch (...) {  // nobody asked
  }
  queue_->called.wait();
}

}  // namespace lodestone
