#include "support/counted_memory.h"

#include <malloc.h>

#include <cstdlib>
#include <new>

namespace lodestone::test {

std::atomic<std::size_t> live_bytes = 0, peak_bytes = 0, allocation_count = 0;

}  // namespace lodestone::test

namespace {

using lodestone::test::live_bytes, lodestone::test::peak_bytes;

// What core/parallel.h tries to get, to see whether there is any memory left, is never written to and given back.
constexpr std::size_t kTrialBytes = 8 << 20;

void* count(void* block, std::size_t bytes) {
  if (block == nullptr) throw std::bad_alloc();
  ++lodestone::test::allocation_count;
  const std::size_t live = live_bytes += malloc_usable_size(block);
  std::size_t peak = peak_bytes;
  while (bytes != kTrialBytes && live > peak && !peak_bytes.compare_exchange_weak(peak, live)) {
  }
  return block;
}

void give_back(void* block) {
  live_bytes -= malloc_usable_size(block);
  std::free(block);
}

}  // namespace

void* operator new(std::size_t bytes) { return count(std::malloc(bytes), bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  const auto step = static_cast<std::size_t>(alignment);
  return count(std::aligned_alloc(step, (bytes + step - 1) / step * step), bytes);
}
// Sanitizers have those of their own, which call none of the above.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  void* const block = std::malloc(bytes);
  return block != nullptr ? count(block, bytes) : nullptr;
}
void operator delete(void* block, const std::nothrow_t&) noexcept { give_back(block); }
void operator delete(void* block) noexcept { give_back(block); }
void operator delete(void* block, std::size_t) noexcept { give_back(block); }
void operator delete(void* block, std::align_val_t) noexcept { give_back(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { give_back(block); }
