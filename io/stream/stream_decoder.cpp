#include "stream/stream_decoder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/core/detail/finite.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "stream/stream_columns.h"

namespace lodestone::detail {

/// The values of a column, in order. Beyond its end they are 0 and exhausted() is true: callers check once per record.
class Values {
 public:
  explicit Values(const Column& column) : values_(&column.values) {}
  std::uint32_t next() {
    if (at_ < values_->size()) return (*values_)[at_++];
    exhausted_ = true;
    return 0;
  }
  std::size_t left() const { return values_->size() - at_; }
  bool exhausted() const { return exhausted_; }

 private:
  const std::vector<std::uint32_t>* values_;
  std::size_t at_ = 0;
  bool exhausted_ = false;
};

/// All columns of a chunk.
class ChunkValues {
 public:
  explicit ChunkValues(std::span<const Column> columns) {
    for (const Column& column : columns) values_.emplace_back(column);
  }
  Values& operator[](std::size_t column) { return values_[column]; }
  bool exhausted() const {
    return std::any_of(values_.begin(), values_.end(), [](const Values& v) { return v.exhausted(); });
  }
  bool used_up() const {
    return std::all_of(values_.begin(), values_.end(), [](const Values& v) { return v.left() == 0; });
  }

 private:
  std::vector<Values> values_;
};

namespace {

tl::unexpected<Error> broken(std::string message) { return fail(ErrorCode::Malformed, std::move(message)); }

std::optional<ComponentType> component_type(std::uint32_t value) {
  const bool known = value >= 5120 && value <= 5126 && value != 5124;
  return known ? std::optional(static_cast<ComponentType>(value)) : std::nullopt;
}

}  // namespace

StreamDecoder::StreamDecoder(StreamStart start, ProgressiveMesh& mesh, std::uint64_t most_bytes)
    : start_(std::move(start)), mesh_(mesh), most_bytes_(most_bytes) {}

Result<void> StreamDecoder::add_chunk(std::span<const std::byte> bytes) {
  const MeshMark before(mesh_);
  Result<void> added = read_chunk(start_.directory.chunks[chunk_count_], bytes);
  if (added)
    ++chunk_count_;
  else
    before.restore(mesh_);
  return added;
}

Result<void> StreamDecoder::read_chunk(const StreamChunk& entry, std::span<const std::byte> bytes) {
  if (checksum64(bytes) != entry.checksum) return broken("the checksum is wrong");
  const std::size_t vertices = mesh_.positions.size(), errors = mesh_.deviation.size();
  LODESTONE_CHECK(chunk_count_ == 0 ? add_base(entry, bytes) : add_records(entry, bytes));
  LODESTONE_CHECK(check_values(vertices, errors));
  for (std::size_t g = 0; g < mesh_.groups.size(); ++g)
    mesh_.groups[g].face_count = static_cast<Index>(faces_->face_count(g));
  LODESTONE_CHECK(check_level(entry));
  return check_held_bytes(mesh_, most_bytes_);
}

/// Checks the positions and errors that a chunk has added.
Result<void> StreamDecoder::check_values(std::size_t first_vertex, std::size_t first_error) const {
  for (std::size_t v = first_vertex; v < mesh_.positions.size(); ++v) {
    if (!is_finite(mesh_.positions[v])) return broken(text("vertex ", v, " has a position that is not finite"));
  }
  for (std::size_t p = first_error; p < mesh_.deviation.size(); ++p)
    for (const float error : {mesh_.deviation[p], mesh_.curvature_error[p]})
      if (!std::isfinite(error) || error < 0)
        return broken(text("position ", p, " has an error that is negative or not finite"));
  return {};
}

/// Checks that the level after a chunk is what the directory says.
Result<void> StreamDecoder::check_level(const StreamChunk& entry) const {
  const bool as_declared =
      face_count() == entry.face_count && mesh_.wedge_vertex.size() == start_.wedge_counts[chunk_count_] &&
      std::bit_cast<std::uint32_t>(mesh_.deviation.back()) == std::bit_cast<std::uint32_t>(entry.deviation) &&
      std::bit_cast<std::uint32_t>(mesh_.curvature_error.back()) == std::bit_cast<std::uint32_t>(entry.curvature_error);
  if (!as_declared) return broken("its level is not the one the directory announces");
  const bool is_whole = mesh_.record_count() == start_.header.record_count;
  const std::size_t rounds = mesh_.round_begin.size() - 1;
  if (is_whole ? rounds != start_.header.round_count : rounds > start_.header.round_count)
    return broken(text(rounds, " rounds, where the header has ", start_.header.round_count));
  return {};
}

std::uint64_t StreamDecoder::face_count() const {
  std::uint64_t count = 0;
  for (std::size_t g = 0; g < mesh_.groups.size(); ++g) count += faces_->face_count(g);
  return count;
}

Result<void> StreamDecoder::add_base(const StreamChunk& entry, std::span<const std::byte> bytes) {
  ColumnReader reader(bytes, entry.decoded_bytes);
  std::vector<Column> columns = base_columns({});
  LODESTONE_CHECK(reader.read(columns[kGroupTable]));
  LODESTONE_CHECK(reader.read(columns[kAttributeTable]));
  LODESTONE_CHECK(read_attribute_table(columns[kAttributeTable]));
  const Column groups = std::move(columns[kGroupTable]);
  columns = base_columns(mesh_.attributes);
  for (std::size_t i = kAttributeTable + 1; i < columns.size(); ++i) LODESTONE_CHECK(reader.read(columns[i]));
  LODESTONE_CHECK(reader.finish());

  LODESTONE_CHECK(check_base_sizes(columns));
  LODESTONE_CHECK(read_base_vertices(columns));
  read_base_attributes(columns);
  LODESTONE_CHECK(read_groups(groups, columns[kBaseCorners]));
  begin_records(entry);
  return {};
}

Result<void> StreamDecoder::read_attribute_table(const Column& column) {
  Values table(column);
  for (std::uint32_t a = 0; a < start_.header.attribute_count; ++a) {
    Attribute attribute;
    const std::uint32_t name_bytes = table.next();
    if (name_bytes > kMaxNameBytes) return broken(text("attribute ", a, " has a name of ", name_bytes, " bytes"));
    for (std::uint32_t i = 0; i < name_bytes; ++i) {
      const std::uint32_t character = table.next();
      if (character > 255) return broken(text("attribute ", a, " has a name with the character ", character));
      attribute.name.push_back(static_cast<char>(character));
    }
    const auto type = component_type(table.next());
    const std::uint32_t count = table.next(), normalized = table.next();
    if (!type || count < 1 || count > 16 || normalized > 1)
      return broken(text("attribute ", a, " has no known layout"));
    attribute.type = *type;
    attribute.component_count = static_cast<std::uint8_t>(count);
    attribute.normalized = normalized == 1;
    mesh_.attributes.push_back(std::move(attribute));
  }
  return table.exhausted() || table.left() > 0 ? broken("the attribute table has another length") : Result<void>{};
}

/// The header's counts are only believed where columns of that length are really there.
Result<void> StreamDecoder::check_base_sizes(std::span<const Column> columns) const {
  for (std::size_t i = kWedgeVertices; i < columns.size(); ++i) {
    if (i == kBaseCorners) continue;
    const bool per_vertex = i >= kBasePositions && i < kFirstBaseAttribute;
    const std::size_t expected = per_vertex ? start_.header.base_vertex_count : start_.header.base_wedge_count;
    if (columns[i].values.size() != expected)
      return broken(text("column ", i, " has ", columns[i].values.size(), " values and not ", expected));
  }
  return {};
}

Result<void> StreamDecoder::read_base_vertices(std::span<const Column> columns) {
  mesh_.base_vertex_count = start_.header.base_vertex_count;
  mesh_.base_wedge_count = start_.header.base_wedge_count;
  std::uint32_t vertex = 0;
  for (const std::uint32_t step : columns[kWedgeVertices].values) {
    vertex += unzigzag(step);
    if (vertex >= mesh_.base_vertex_count)
      return broken(text("a wedge names vertex ", vertex, " of ", mesh_.base_vertex_count));
    mesh_.wedge_vertex.push_back(vertex);
  }
  std::array<std::uint32_t, 3> p{};
  for (Index v = 0; v < mesh_.base_vertex_count; ++v) {
    for (std::size_t c = 0; c < 3; ++c) p[c] += unzigzag(columns[kBasePositions + c].values[v]);
    mesh_.positions.push_back({from_ordered_bits(p[0]), from_ordered_bits(p[1]), from_ordered_bits(p[2])});
  }
  return {};
}

void StreamDecoder::read_base_attributes(std::span<const Column> columns) {
  std::size_t column = kFirstBaseAttribute;
  for (Attribute& a : mesh_.attributes) {
    const OrderedComponents ordered(a.type);
    const std::size_t size = component_bytes(a.type);
    a.data.resize(mesh_.base_wedge_count * a.element_bytes());
    for (std::size_t c = 0; c < a.component_count; ++c, ++column) {
      std::uint32_t value = 0;
      for (std::size_t w = 0; w < mesh_.base_wedge_count; ++w) {
        value = ordered.restore(columns[column].values[w], value);
        ordered.store(value, std::span(a.data).subspan(w * a.element_bytes() + c * size, size));
      }
    }
  }
}

Result<void> StreamDecoder::read_groups(const Column& table, const Column& corner_steps) {
  if (table.values.size() != 2 * std::size_t{start_.header.group_count})
    return broken("the group table has another length");
  Values steps(corner_steps);
  std::uint32_t last = 0;
  for (std::size_t g = 0; g < table.values.size(); g += 2) {
    FaceGroup group{table.values[g], 0, {}};
    if (table.values[g + 1] > steps.left() / 3) return broken(text("group ", g / 2, " has more faces than there are"));
    for (std::size_t i = 0; i < 3 * std::size_t{table.values[g + 1]}; ++i) {
      last += unzigzag(steps.next());
      if (last >= mesh_.base_wedge_count) return broken(text("group ", g / 2, " names wedge ", last));
      group.base_corners.push_back(last);
    }
    mesh_.groups.push_back(std::move(group));
  }
  return steps.left() > 0 ? broken("corners belong to no group") : Result<void>{};
}

void StreamDecoder::begin_records(const StreamChunk& entry) {
  mesh_.record_wedge_begin = {mesh_.base_wedge_count};
  mesh_.sector_begin = {0};
  mesh_.polygon_begin = {0};
  mesh_.round_begin = {0};
  mesh_.deviation = {entry.deviation};
  mesh_.curvature_error = {entry.curvature_error};
  faces_.emplace(mesh_.groups);
}

Result<void> StreamDecoder::add_records(const StreamChunk& entry, std::span<const std::byte> bytes) {
  ColumnReader reader(bytes, entry.decoded_bytes);
  std::vector<Column> columns = record_columns(mesh_.attributes);
  for (Column& column : columns) LODESTONE_CHECK(reader.read(column));
  LODESTONE_CHECK(reader.finish());
  ChunkValues values(columns);
  LODESTONE_CHECK(read_rounds(entry, values[kRoundSizes]));
  for (Index i = 0; i < entry.record_count; ++i) LODESTONE_CHECK(read_record(values));
  if (!values.used_up()) return broken("values belong to no record");
  return {};
}

Result<void> StreamDecoder::read_rounds(const StreamChunk& entry, Values& sizes) {
  const std::uint64_t end = std::uint64_t{entry.record_begin} + entry.record_count;
  while (sizes.left() > 0) {
    const std::uint64_t round_end = std::uint64_t{mesh_.round_begin.back()} + sizes.next();
    if (round_end == mesh_.round_begin.back() || round_end > end) return broken("a round is empty or too long");
    mesh_.round_begin.push_back(static_cast<Index>(round_end));
  }
  return mesh_.round_begin.back() == end ? Result<void>{} : broken("the rounds do not cover the chunk's records");
}

Result<void> StreamDecoder::read_record(ChunkValues& values) {
  const std::size_t record = mesh_.record_count();
  const auto at_record = [&](Error error) {
    error.message = text("record ", record, ": ", error.message);
    return error;
  };
  LODESTONE_CHECK(read_connectivity(record, values).map_error(at_record));
  read_errors(values);
  read_position(record, values);
  read_attributes(record, values);
  if (values.exhausted()) return broken(text("record ", record, ": a column ends"));
  faces_->refine(mesh_, record);
  return {};
}

/// Appends the record's wedges and sectors.
Result<void> StreamDecoder::read_connectivity(std::size_t record, ChunkValues& values) {
  const std::uint32_t wedge_count = values[kWedgeCounts].next(), sector_count = values[kSectorCounts].next();
  if (wedge_count > kMaxWedgesPerRecord || wedge_count > start_.header.wedge_count - mesh_.wedge_vertex.size())
    return broken(text(wedge_count, " wedges"));
  if (sector_count > values[kPolygonSizes].left()) return broken("more sectors than there are");
  for (std::uint32_t s = 0; s < sector_count; ++s) LODESTONE_CHECK(read_sector(wedge_count, values));
  mesh_.sector_begin.push_back(static_cast<Index>(mesh_.sectors.size()));
  mesh_.wedge_vertex.insert(mesh_.wedge_vertex.end(), wedge_count,
                            static_cast<Index>(mesh_.base_vertex_count + record));
  mesh_.record_wedge_begin.push_back(static_cast<Index>(mesh_.wedge_vertex.size()));
  return {};
}

Result<void> StreamDecoder::read_sector(std::uint32_t wedge_count, ChunkValues& values) {
  const std::uint32_t size = values[kPolygonSizes].next(), group = values[kGroups].next(),
                      centre = values[kCentres].next();
  const std::uint32_t shapes = start_.directory.version_major == 1 ? 2 : 4;  // version 1 had two
  const auto shape = static_cast<SectorShape>(centre % shapes);
  if (size < (shape == SectorShape::Open || shape == SectorShape::Lone ? 2u : 3u) ||
      size > (shape == SectorShape::Lone ? 2u : kMaxPolygonSize))
    return broken(text("polygon of ", size, " corners"));
  if (group >= mesh_.groups.size()) return broken(text("group ", group, " of ", mesh_.groups.size()));
  if (centre / shapes >= wedge_count) return broken(text("wedge ", centre / shapes, " of ", wedge_count));
  mesh_.sectors.push_back({static_cast<std::uint16_t>(size), static_cast<std::uint16_t>(group),
                           static_cast<std::uint16_t>(centre / shapes), shape});
  tracer_.begin(size);
  for (std::uint32_t i = 0; i + 2 < size; ++i) LODESTONE_CHECK(read_slot(group, i == 0, size, values));
  for (const Index wedge : tracer_.wedges())
    mesh_.polygons.push_back(wedge != kNoIndex ? wedge : values[kLooseWedges].next());
  mesh_.polygon_begin.push_back(mesh_.polygons.size());
  for (auto i = mesh_.polygons.size() - size; i < mesh_.polygons.size(); ++i)
    if (mesh_.polygons[i] >= mesh_.wedge_vertex.size())
      return broken(text("wedge ", mesh_.polygons[i], " does not exist yet"));
  return check_coarse_faces(group);
}

/// Checks that coarsening brings back the faces that lie in the last sector's slots, byte for byte.
Result<void> StreamDecoder::check_coarse_faces(std::uint32_t group) const {
  const std::size_t sector = mesh_.sectors.size() - 1;
  const Index* polygon = mesh_.polygons.data() + mesh_.polygon_begin[sector];
  for (std::uint64_t i = mesh_.slot_begin(sector); i < mesh_.slots.size(); ++i) {
    const std::uint8_t* t = &mesh_.triangles[3 * i];
    std::array<Index, 3> face = {polygon[t[0]], polygon[t[1]], polygon[t[2]]};
    std::rotate(face.begin(), std::max_element(face.begin(), face.end()), face.end());
    const auto there = faces_->face(group, mesh_.slots[i]);
    if (!std::equal(face.begin(), face.end(), there.begin()))
      return broken(text("does not fit face ", mesh_.slots[i], " of group ", group));
  }
  return {};
}

/// Appends a slot with its triangle, and traces the corners of the face that lies there.
Result<void> StreamDecoder::read_slot(std::uint32_t group, bool first, std::uint32_t size, ChunkValues& values) {
  std::array<std::uint8_t, 3> triangle{};
  for (std::uint8_t& corner : triangle) corner = static_cast<std::uint8_t>(values[kTriangles].next());
  if (!(triangle[0] < triangle[1] && triangle[1] < triangle[2] && triangle[2] < size))
    return broken("a triangle is outside its polygon");
  const std::uint32_t code = first ? values[kFirstSlots].next() : values[kOtherSlots].next();
  const Index expected = tracer_.expected_slot(triangle), slot = first ? code : code == 0 ? expected : code - 1;
  if (!first && code != 0 && slot == expected) return broken(text("face ", slot, " is the expected one, which 0 says"));
  if (slot >= faces_->face_count(group)) return broken(text("face ", slot, " of ", faces_->face_count(group)));
  const auto face = faces_->face(group, slot);
  int rotation = tracer_.rotation_of(triangle, face);
  if (rotation == PolygonTracer::kFree) rotation = static_cast<int>(std::min(values[kRotations].next(), 3u));
  if (rotation < 0 || rotation > 2 || !tracer_.trace(triangle, *faces_, group, slot, rotation))
    return broken("a face does not fit its polygon");
  mesh_.slots.push_back(slot);
  mesh_.triangles.insert(mesh_.triangles.end(), triangle.begin(), triangle.end());
  return {};
}

void StreamDecoder::read_errors(ChunkValues& values) {
  const auto read = [&](std::size_t column, std::vector<float>& errors) {
    errors.push_back(from_ordered_bits(ordered_bits(errors.back()) + unzigzag(values[column].next())));
  };
  read(kDeviations, mesh_.deviation);
  read(kCurvatures, mesh_.curvature_error);
}

void StreamDecoder::read_position(std::size_t record, ChunkValues& values) {
  std::array<std::uint32_t, 3> p = predict_position(mesh_, record);
  for (std::size_t c = 0; c < 3; ++c) p[c] += unzigzag(values[kPositions + c].next());
  mesh_.positions.push_back({from_ordered_bits(p[0]), from_ordered_bits(p[1]), from_ordered_bits(p[2])});
}

void StreamDecoder::read_attributes(std::size_t record, ChunkValues& values) {
  std::size_t column = kFirstAttribute;
  const Index first = mesh_.record_wedge_begin[record], end = mesh_.record_wedge_begin[record + 1];
  for (Attribute& a : mesh_.attributes) {
    const OrderedComponents ordered(a.type);
    const std::size_t size = component_bytes(a.type);
    a.data.resize(end * a.element_bytes());
    for (std::size_t c = 0; c < a.component_count; ++c, ++column)
      for (Index w = first; w < end; ++w) {
        const std::uint32_t predicted = predict_component(mesh_, record, static_cast<int>(w - first), a, ordered, c);
        ordered.store(ordered.restore(values[column].next(), predicted),
                      std::span(a.data).subspan(w * a.element_bytes() + c * size, size));
      }
  }
}

}  // namespace lodestone::detail
