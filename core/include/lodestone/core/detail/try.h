#pragma once

#include <utility>

#include <lodestone/core/result.h>

// Much is a chain of steps that can each fail; these two hand the first error to the caller.

#define LODESTONE_JOIN_IMPL(a, b) a##b
#define LODESTONE_JOIN(a, b) LODESTONE_JOIN_IMPL(a, b)

#define LODESTONE_TRY_IMPL(result, declaration, expression)                          \
  auto result = (expression);                                                        \
  if (!result) return tl::unexpected<::lodestone::Error>(std::move(result).error()); \
  declaration = std::move(*result)

/// `LODESTONE_TRY(const auto view, document.buffer_view(3));` declares `view`, or returns the expression's error.
#define LODESTONE_TRY(declaration, expression) \
  LODESTONE_TRY_IMPL(LODESTONE_JOIN(lodestone_try_, __LINE__), declaration, expression)

/// `LODESTONE_CHECK(validate(mesh));` returns the expression's error, if it has one.
#define LODESTONE_CHECK(expression)                                                                                \
  if (auto LODESTONE_JOIN(lodestone_check_, __LINE__) = (expression); !LODESTONE_JOIN(lodestone_check_, __LINE__)) \
  return tl::unexpected<::lodestone::Error>(std::move(LODESTONE_JOIN(lodestone_check_, __LINE__)).error())
