#include <lodestone/io/draw_cursor.h>

#include <cstring>
#include <vector>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/simplify.h>

#include "support/arriving.h"
#include "support/counted_memory.h"
#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/placed_shapes.h"
#include "support/progressive_shapes.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

/// What an engine has: buffers into which only the ranges named are written.
class Engine {
 public:
  Engine(const ProgressiveMesh& mesh, DrawCursor& cursor)
      : mesh_(&mesh), cursor_(&cursor), corners_(cursor.group_count()) {}

  void upload(std::size_t gap) {
    const EntryRange wedges = cursor_->take_new_wedges();
    REQUIRE(3 * wedges.begin == positions_.size());
    positions_.resize(3 * wedges.end);
    copy_positions(*mesh_, *cursor_, wedges, positions_.data() + 3 * wedges.begin);
    cursor_->take_moved_wedges(gap, ranges_);
    for (const EntryRange& range : ranges_) {
      REQUIRE(range.begin < range.end);
      REQUIRE(3 * range.end <= positions_.size());
      copy_positions(*mesh_, *cursor_, range, positions_.data() + 3 * range.begin);
    }
    for (std::size_t group = 0; group < corners_.size(); ++group) upload_group(group, gap);
  }

  void check() const {
    REQUIRE(positions_.size() >= 3 * cursor_->wedge_count());
    const std::vector<Vec3f> positions = positions_at(*mesh_, cursor_->position());
    for (std::size_t w = 0; w < cursor_->wedge_count(); ++w) {
      const Vec3f& there = positions[mesh_->wedge_vertex[w]];
      REQUIRE(Vec3f{positions_[3 * w], positions_[3 * w + 1], positions_[3 * w + 2]} == there);
    }
    for (std::size_t group = 0; group < corners_.size(); ++group) {
      const auto wanted = cursor_->corners(group);
      REQUIRE(corners_[group].size() >= wanted.size());
      REQUIRE(std::equal(wanted.begin(), wanted.end(), corners_[group].begin()));
    }
  }

  std::size_t uploaded() const { return uploaded_; }

 private:
  void upload_group(std::size_t group, std::size_t gap) {
    const auto wanted = cursor_->corners(group);
    cursor_->take_changes(group, gap, ranges_);
    std::size_t last = 0;
    for (const EntryRange& range : ranges_) {
      REQUIRE(range.begin < range.end);
      REQUIRE(range.end <= wanted.size());
      REQUIRE((&range == ranges_.data() || range.begin > last + gap));
      last = range.end;
      uploaded_ += range.size();
      if (corners_[group].size() < range.end) corners_[group].resize(range.end, kNoIndex);
      std::copy(wanted.begin() + static_cast<std::ptrdiff_t>(range.begin),
                wanted.begin() + static_cast<std::ptrdiff_t>(range.end),
                corners_[group].begin() + static_cast<std::ptrdiff_t>(range.begin));
    }
  }

  const ProgressiveMesh* mesh_;
  DrawCursor* cursor_;
  std::vector<float> positions_;
  std::vector<std::vector<Index>> corners_;
  std::vector<EntryRange> ranges_;
  std::size_t uploaded_ = 0;
};

ProgressiveMesh dense(const TriangleSoup& soup) {
  SimplifyOptions options;
  options.dense_rounds = 1.5;
  options.measure_step = 0;
  return std::move(simplify(mesh_of(soup), options).value().mesh);
}

}  // namespace

TEST_CASE("who writes the ranges named and no others has the buffers of the level, whatever the moves") {
  Random random(3);
  std::vector<ProgressiveMesh> meshes = progressive_shapes();
  for (ProgressiveMesh moved : progressive_shapes()) {
    add_moves(moved, 0.1, random.next());
    meshes.push_back(std::move(moved));
  }
  for (const ProgressiveMesh& mesh : meshes) {
    DrawCursor cursor(mesh);
    Engine engine(mesh, cursor);
    for (int i = 0; i < 30; ++i) {
      if (random.below(3) > 0) engine.upload(random.below(2) * random.below(1000));  // several moves between some
      cursor.seek(static_cast<Index>(random.below(mesh.record_count() + 1)));
      Cursor plain(mesh);
      plain.seek(cursor.position());
      REQUIRE(cursor.face_count() == plain.face_count());
      REQUIRE(cursor.wedge_count() == plain.wedge_count());
    }
    engine.upload(0);
    engine.check();
  }
}

TEST_CASE("the buffers follow a stream that arrives") {
  const ProgressiveMesh mesh = dense(terrain(60, 3));
  const auto stream = encode_compact(mesh, {}, scattered_levels(mesh, 2, 0.01, 0.01, 1));
  REQUIRE(stream);
  StreamReader reader;
  Random random(4);
  std::optional<DrawCursor> cursor;
  std::optional<Engine> engine;
  arrive(stream->bytes, 400, random, reader, [&] {
    if (!cursor) {
      cursor.emplace(reader.mesh());
      engine.emplace(reader.mesh(), *cursor);
    }
    cursor->seek(static_cast<Index>(random.below(reader.mesh().record_count() + 1)));
    engine->upload(0);
    engine->check();
  });
  cursor->seek(kNoIndex);
  engine->upload(0);
  engine->check();
  CHECK(cursor->position() == reader.mesh().record_count());
}

TEST_CASE("a small move uploads little, none nothing, and moves allocate nothing") {
  ProgressiveMesh mesh = dense(icosphere(kReduced ? 4 : 5, 0.02, 1));
  add_moves(mesh, 0.01, 2);
  const auto last = static_cast<Index>(mesh.record_count());
  DrawCursor cursor(mesh);
  Engine engine(mesh, cursor);
  cursor.seek(last);
  engine.upload(0);
  const std::size_t all = engine.uploaded();
  engine.upload(0);
  CHECK(engine.uploaded() == all);
  cursor.seek(last - 20);
  engine.upload(0);
  engine.check();
  // Twenty records of six faces, in blocks of 64 faces at most.
  CHECK(engine.uploaded() - all <= 20 * 6 * 64 * 3);

  const std::size_t allocations = allocation_count;
  for (const Index goal : {Index{0}, last, last / 2, last / 3, last}) cursor.seek(goal);
  CHECK(allocation_count == allocations);
}

TEST_CASE("normals are those of the faces around, one for all wedges of a vertex") {
  for (const ProgressiveMesh& mesh : progressive_shapes()) {
    DrawCursor cursor(mesh);
    cursor.seek(static_cast<Index>(mesh.record_count() / 2));
    std::vector<float> normals(3 * cursor.wedge_count());
    copy_normals(mesh, cursor, normals.data());
    const auto normal = [&](std::size_t w) { return Vec3(normals[3 * w], normals[3 * w + 1], normals[3 * w + 2]); };
    const Mesh level = extract_level(mesh, cursor.position());
    std::vector<Vec3> sums(level.vertex_count());
    for (Index f = 0; f < level.face_count(); ++f)
      for (Index c = 3 * f; c < 3 * f + 3; ++c) sums[level.corner_vertex(c)] += area_vector(level, f);
    for (std::size_t w = 0; w < cursor.wedge_count(); ++w) {
      const Vec3& sum = sums[mesh.wedge_vertex[w]];
      if (length(sum) > 1e-9) CHECK(length(normal(w) - normalized(sum)) < 1e-5);
      if (sum == Vec3{}) CHECK(length(normal(w)) == 0);
    }
  }
}

}  // namespace lodestone::test
