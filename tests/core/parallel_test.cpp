#include <lodestone/core/parallel.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.h"

namespace lodestone::test {
namespace {

/// What a loop over jobs throws: its message, or nothing.
template <class Loop>
std::string thrown_by(const Loop& loop) {
  try {
    loop();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("every job runs once, for any number of jobs and threads") {
  for (const std::size_t threads : {0, 1, 2, 7})
    for (const std::size_t count : {0, 1, 2, 100, 1000}) {
      CAPTURE(threads, count);
      std::vector<int> runs(count, 0);
      with_threads(threads, [&] { for_each_in_parallel(count, [&](std::size_t i) { ++runs[i]; }); });
      CHECK(runs == std::vector<int>(count, 1));
    }
}

TEST_CASE("chunks do not depend on the threads, and sums over them are the same bits") {
  const auto sum = [](std::size_t threads) {
    std::vector<double> sums(334, 0);
    with_threads(threads, [&] {
      for_each_chunk(1000, 3, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) sums[begin / 3] += 1.0 / static_cast<double>(i + 1);
      });
    });
    double total = 0;
    for (const double part : sums) total += part;
    return total;
  };
  CHECK(sum(1) > 7.4);
  for (const std::size_t threads : {0, 2, 3, 8}) CHECK(sum(threads) == sum(1));
  std::size_t end_of_last = 0;
  for_each_chunk(10, 4, [&](std::size_t begin, std::size_t end) {
    if (begin == 8) end_of_last = end;
  });
  CHECK(end_of_last == 10);
}

TEST_CASE("at most so many jobs run at a time, nested loops included") {
  for (const std::size_t threads : {1, 2}) {
    std::atomic<std::size_t> running{0}, most{0};
    const auto job = [&](std::size_t) {
      const std::size_t now = ++running;
      for (std::size_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
      }
      std::this_thread::yield();
      --running;
    };
    with_threads(threads, [&] {
      with_threads(8, [&] { for_each_in_parallel(8, [&](std::size_t) { for_each_in_parallel(20, job); }); });
    });
    CHECK(most <= threads);
  }
}

TEST_CASE("one thread is the caller's") {
  const std::thread::id caller = std::this_thread::get_id();
  bool is_caller = true;
  with_threads(1, [&] {
    for_each_in_parallel(50, [&](std::size_t) { is_caller = is_caller && std::this_thread::get_id() == caller; });
  });
  CHECK(is_caller);
}

TEST_CASE("the exception of the lowest job that throws reaches the caller, through nested loops, too") {
  const auto fail_from = [](std::size_t first) {
    return [first](std::size_t i) {
      if (i >= first) throw std::runtime_error("job " + std::to_string(i));
    };
  };
  for (const std::size_t threads : {0, 1, 4})
    for (const std::size_t first : {0, 1, 37, 99}) {
      CAPTURE(threads, first);
      const auto expected = "job " + std::to_string(first);
      with_threads(threads, [&] {
        CHECK(thrown_by([&] { for_each_in_parallel(100, fail_from(first)); }) == expected);
        CHECK(thrown_by([&] {
                for_each_in_parallel(10, [&](std::size_t) { for_each_in_parallel(100, fail_from(first)); });
              }) == expected);
      });
      CHECK(thrown_by([&] { with_threads(threads, [&] { for_each_in_parallel(100, fail_from(first)); }); }) ==
            expected);
    }
}

TEST_CASE("side jobs are done in their order, one at a time, while their owner goes on with loops of its own") {
  for (const std::size_t threads : {0, 1, 2, 4}) {
    CAPTURE(threads);
    std::vector<int> done;
    std::vector<int> counts(64, 0);
    std::atomic<int> running{0};
    bool any_beside = false;  // another one
    with_threads(threads, [&] {
      SideJobs jobs;
      for (int i = 0; i < 20; ++i) {
        jobs.add([&, i] {
          any_beside = any_beside || ++running > 1;
          for_each_in_parallel(8, [&](std::size_t) { std::this_thread::yield(); });
          done.push_back(i);
          --running;
        });
        for_each_in_parallel(counts.size(), [&](std::size_t k) { ++counts[k]; });
      }
      jobs.wait();
      CHECK(done.size() == 20);
      jobs.wait();
    });
    CHECK(std::is_sorted(done.begin(), done.end()));
    CHECK_FALSE(any_beside);
    CHECK(counts == std::vector<int>(counts.size(), 20));
  }
}

TEST_CASE("an owner waits until so many side jobs are left, and its end until none is") {
  for (const std::size_t threads : {1, 2}) {
    std::atomic<std::size_t> done{0};
    with_threads(threads, [&] {
      SideJobs jobs;
      for (std::size_t i = 0; i < 10; ++i) jobs.add([&] { ++done; });
      jobs.wait(4);
      CHECK(done >= 6);
    });
    CHECK(done == 10);
  }
}

TEST_CASE("side jobs that an owner leaves are done though it waits for them no more") {
  with_threads(2, [] {
    SideJobs jobs;
    std::atomic<std::size_t> done{0};
    for (std::size_t i = 0; i < 10; ++i) jobs.add([&] { ++done; });
    jobs.wait(4);
    while (done < 10) std::this_thread::yield();
  });
}

TEST_CASE("one thread does side jobs when they are added") {
  with_threads(1, [] {
    SideJobs jobs;
    bool done = false;
    jobs.add([&] { done = true; });
    CHECK(done);
  });
}

TEST_CASE("what a side job throws its owner hears, once, and those after it are not done") {
  for (const std::size_t threads : {1, 2, 4}) {
    CAPTURE(threads);
    bool went_on = false, begins_anew = false;
    with_threads(threads, [&] {
      SideJobs jobs;
      jobs.add([] { throw std::runtime_error("job"); });
      jobs.add([&] { went_on = true; });
      CHECK(thrown_by([&] { jobs.wait(); }) == "job");
      jobs.add([&] { begins_anew = true; });
      CHECK(thrown_by([&] { jobs.wait(); }).empty());
      jobs.add([] { throw std::runtime_error("lost"); });
    });
    CHECK_FALSE(went_on);
    CHECK(begins_anew);
  }
}

}  // namespace lodestone::test
