#pragma once

// Catch2 2.13 (Debian 12) or 3 (Debian 13): tests include this and not Catch2's own headers.

#include <string>

#if __has_include(<catch2/catch_test_macros.hpp>)
#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/generators/catch_generators_range.hpp>
#include <catch2/matchers/catch_matchers.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#define LODESTONE_CATCH2_VERSION 3
#else
#include <catch2/catch.hpp>
#define LODESTONE_CATCH2_VERSION 2
#endif

namespace lodestone::test {

#if LODESTONE_CATCH2_VERSION == 3
using Catch::Approx;
#else
using Catch::Detail::Approx;
#endif

/// Matches strings that contain `text`; version 3 gave version 2's `Contains` another name.
inline auto contains(const std::string& text) {
#if LODESTONE_CATCH2_VERSION == 3
  return Catch::Matchers::ContainsSubstring(text);
#else
  return Catch::Matchers::Contains(text);
#endif
}

}  // namespace lodestone::test
