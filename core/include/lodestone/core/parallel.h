#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace lodestone {

/// Runs `work`; the loops below, wherever they are called inside it, share at most so many threads, the caller's among
/// them. 0: as many as the machine has cores, which is also what loops outside of any such call use.
/// Nested calls may only lower the number. What `work` throws is thrown here.
void with_threads(std::size_t thread_count, const std::function<void()>& work);

/// Calls `job(i)` for every i below `count` and returns when all are done. What jobs write must not overlap: then the
/// result does not depend on the number of threads. Jobs may hold such loops themselves.
///
/// Where jobs throw, the exception of the lowest i among them is thrown here, after all that had begun have ended; jobs
/// of a higher i may then never run.
void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& job);

/// Calls `job(begin, end)` for the consecutive ranges of `chunk_size` numbers, the last one perhaps shorter, that make
/// up 0 … count − 1. They do not depend on the number of threads: sums kept for each and joined in their order are
/// always the same. Pre: chunk_size > 0. Exceptions as above.
void for_each_chunk(std::size_t count, std::size_t chunk_size,
                    const std::function<void(std::size_t begin, std::size_t end)>& job);

/// A job that is done while its owner goes on, by another of the threads that loops share, if one has time before the
/// owner waits for it. One after the other.
class SideJob {
 public:
  SideJob() = default;
  SideJob(const SideJob&) = delete;
  SideJob& operator=(const SideJob&) = delete;
  /// Waits; what the job throws is lost.
  ~SideJob();

  /// Has `job` done, at once where there are no other threads. Pre: the one before it was waited for.
  void start(std::function<void()> job);
  /// Returns when the job is done: does it, if nobody has begun. What it throws is thrown here. Without one, nothing.
  void wait();

 private:
  struct Task;
  std::shared_ptr<Task> task_;
};

}  // namespace lodestone
