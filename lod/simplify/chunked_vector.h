#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace lodestone::detail {

/// A sequence that grows without copying: it takes what it holds, and a few kilobytes.
template <class T>
class ChunkedVector {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }
  const T& back() const { return (*this)[size_ - 1]; }

  void push_back(const T& value) {
    if (size_ == chunks_.size() * kChunk) chunks_.push_back(std::make_unique_for_overwrite<T[]>(kChunk));
    chunks_[size_ / kChunk][size_ % kChunk] = value;
    ++size_;
  }
  void append(const std::vector<T>& values) {
    for (const T& value : values) push_back(value);
  }

 private:
  static constexpr std::size_t kChunk = 4096;

  std::vector<std::unique_ptr<T[]>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace lodestone::detail
