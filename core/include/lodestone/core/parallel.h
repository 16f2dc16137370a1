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

/// Jobs that are done one after the other while their owner goes on: by another of the threads that loops share where
/// one has time, and by the owner where it waits for what nobody has begun.
class SideJobs {
 public:
  SideJobs();
  SideJobs(const SideJobs&) = delete;
  SideJobs& operator=(const SideJobs&) = delete;
  /// Waits for all; what they throw is lost.
  ~SideJobs();

  /// Adds a job; does it at once where there are no other threads.
  void add(std::function<void()> job);
  /// Returns when no more than so many are left to be done. What a job threw is thrown here, and those after it are not
  /// done.
  void wait(std::size_t most_left = 0);

 private:
  void call_for_work();

  struct Queue;
  std::unique_ptr<Queue> queue_;
};

}  // namespace lodestone
