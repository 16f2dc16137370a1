#include <lodestone/core/validate.h>

#include <lodestone/core/detail/index_limit.h>

#include "support/mesh_properties.h"

namespace lodestone::test {

TEST_CASE("validate accepts every assembled shape") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    CHECK(validate(mesh_of(shape.soup)));
  }
}

TEST_CASE("validate names the defect of a mesh") {
  const Mesh good = mesh_of(seam_cube(2));
  const auto message = [&](auto&& spoil) {
    Mesh mesh = good;
    spoil(mesh);
    const auto result = validate(mesh);
    return result ? std::string("valid") : result.error().message;
  };
  CHECK(message([](Mesh&) {}) == "valid");
  CHECK_THAT(message([](Mesh& m) { m.corner_wedge.pop_back(); }), contains("not a multiple of 3"));
  CHECK_THAT(message([](Mesh& m) { m.corner_wedge[5] = 100000; }), contains("corner 5 names wedge 100000"));
  CHECK_THAT(message([](Mesh& m) { m.wedge_vertex[3] = 100000; }), contains("wedge 3 names vertex 100000"));
  CHECK_THAT(message([](Mesh& m) { m.face_material.assign(1, 0); }), contains("material count 1 differs"));
  CHECK_THAT(message([](Mesh& m) { m.attributes[0].data.pop_back(); }), contains("attribute "));
}

TEST_CASE("more than 32-bit indices can number is a limit, named with its numbers") {
  CHECK(detail::check_index_limit("corners", 4'294'967'295));
  const auto beyond = detail::check_index_limit("corners", 4'294'967'296);
  REQUIRE_FALSE(beyond);
  CHECK(beyond.error().code == ErrorCode::LimitExceeded);
  CHECK(beyond.error().message == "4294967296 corners are more than the 4294967295 that 32-bit indices can number");
  CHECK_FALSE(detail::check_index_limit("corners", 7, 6));
}

}  // namespace lodestone::test
