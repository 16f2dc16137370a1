#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

#include "support/catch.h"

namespace lodestone::test {
namespace {

template <class T>
std::vector<float> values_of(ComponentType type, bool normalized, const std::vector<T>& stored) {
  return component_values(type, normalized, std::as_bytes(std::span(stored)));
}

template <class T>
T stored_as(ComponentType type, bool normalized, double value) {
  std::array<std::byte, sizeof(T)> bytes{};
  store_component(type, normalized, value, bytes.data());
  T stored{};
  std::memcpy(&stored, bytes.data(), sizeof stored);
  return stored;
}

/// All values of an integer type come back from their floats, but for the two that stand for −1.
template <class T>
void check_every_value(ComponentType type) {
  for (int i = std::numeric_limits<T>::min(); i <= std::numeric_limits<T>::max(); ++i) {
    const T value = static_cast<T>(i);
    const double plain = values_of<T>(type, false, {value})[0];
    const double unit = values_of<T>(type, true, {value})[0];
    const bool back = stored_as<T>(type, false, plain) == value && plain == i && -1 <= unit && unit <= 1 &&
                      stored_as<T>(type, true, unit) == std::max(i, -int{std::numeric_limits<T>::max()});
    if (!back) FAIL_CHECK("value " << i);
  }
}

}  // namespace

using Floats = std::vector<float>;

TEST_CASE("normalized integers end at exactly 1, 0 and −1") {
  CHECK(values_of<std::int8_t>(ComponentType::Int8, true, {-128, -127, 0, 127}) == Floats{-1, -1, 0, 1});
  CHECK(values_of<std::uint8_t>(ComponentType::UInt8, true, {0, 51, 255}) == Floats{0, 0.2F, 1});
  CHECK(values_of<std::int16_t>(ComponentType::Int16, true, {-32768, -32767, 0, 32767}) == Floats{-1, -1, 0, 1});
  CHECK(values_of<std::uint16_t>(ComponentType::UInt16, true, {0, 13107, 65535}) == Floats{0, 0.2F, 1});
  CHECK(values_of<std::uint32_t>(ComponentType::UInt32, true, {0, 0xffffffff}) == Floats{0, 1});
}

TEST_CASE("integers that are not normalized, and floats, are what they are") {
  CHECK(values_of<std::int8_t>(ComponentType::Int8, false, {-128, 127}) == Floats{-128, 127});
  CHECK(values_of<std::int16_t>(ComponentType::Int16, false, {-32768, 32767}) == Floats{-32768, 32767});
  CHECK(values_of<std::uint16_t>(ComponentType::UInt16, false, {65535}) == Floats{65535});
  CHECK(values_of<float>(ComponentType::Float32, false, {-3.5F, 7e30F}) == Floats{-3.5F, 7e30F});
  CHECK(values_of<float>(ComponentType::Float32, true, {-3.5F}) == Floats{-3.5F});
}

TEST_CASE("components are stored as the nearest value that there is") {
  check_every_value<std::int8_t>(ComponentType::Int8);
  check_every_value<std::uint8_t>(ComponentType::UInt8);
  check_every_value<std::int16_t>(ComponentType::Int16);
  check_every_value<std::uint16_t>(ComponentType::UInt16);
  CHECK(stored_as<std::uint8_t>(ComponentType::UInt8, true, 1.5) == 255);
  CHECK(stored_as<std::uint8_t>(ComponentType::UInt8, true, -0.1) == 0);
  CHECK(stored_as<std::uint8_t>(ComponentType::UInt8, true, 0.299 / 255) == 0);
  CHECK(stored_as<std::int16_t>(ComponentType::Int16, false, 1e9) == 32767);
  CHECK(stored_as<std::uint32_t>(ComponentType::UInt32, false, 4294967295.0) == 0xffffffff);
  CHECK(stored_as<float>(ComponentType::Float32, true, 1.5) == 1.5F);
}

}  // namespace lodestone::test
