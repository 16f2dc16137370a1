#include <lodestone/io/stream_format.h>

#include <algorithm>
#include <limits>
#include <string>

#include <lodestone/core/detail/cancelled.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "stream/stream_columns.h"
#include "stream/stream_layout.h"
#include "stream/stream_records.h"

namespace lodestone {
namespace {

using namespace detail;

constexpr int kMaxZstdLevel = 19;

Result<void> check_limits(const ProgressiveMesh& mesh) {
  const auto beyond = [](const char* what, std::uint64_t count, std::uint64_t limit) {
    return fail(ErrorCode::LimitExceeded, text("stream: ", count, ' ', what, " are more than the limit of ", limit));
  };
  if (mesh.groups.size() > kMaxGroups) return beyond("face groups", mesh.groups.size(), kMaxGroups);
  if (mesh.attributes.size() > kMaxAttributes) return beyond("attributes", mesh.attributes.size(), kMaxAttributes);
  if (mesh.wedge_vertex.size() >= kNoIndex) return beyond("wedges", mesh.wedge_vertex.size(), kNoIndex);
  for (const Attribute& a : mesh.attributes)
    if (a.name.size() > kMaxNameBytes) return beyond("bytes of an attribute's name", a.name.size(), kMaxNameBytes);
  for (const SectorHeader& sector : mesh.sectors)
    if (sector.polygon_size > kMaxPolygonSize)
      return beyond("corners of a polygon", sector.polygon_size, kMaxPolygonSize);
  for (std::size_t k = 0; k < mesh.record_count(); ++k)
    if (const Index wedges = mesh.record_wedge_begin[k + 1] - mesh.record_wedge_begin[k]; wedges > kMaxWedgesPerRecord)
      return beyond("wedges of a record", wedges, kMaxWedgesPerRecord);
  return {};
}

/// Appends the difference of a sequence's next value to its last.
class Steps {
 public:
  explicit Steps(Column& column) : column_(column) {}
  void add(std::uint32_t value) { column_.values.push_back(zigzag(value - std::exchange(last_, value))); }

 private:
  Column& column_;
  std::uint32_t last_ = 0;
};

void add_base_tables(const ProgressiveMesh& mesh, std::vector<Column>& columns) {
  auto& groups = columns[kGroupTable].values;
  for (const FaceGroup& group : mesh.groups)
    groups.insert(groups.end(), {group.material, static_cast<std::uint32_t>(group.base_corners.size() / 3)});
  auto& table = columns[kAttributeTable].values;
  for (const Attribute& a : mesh.attributes) {
    table.push_back(static_cast<std::uint32_t>(a.name.size()));
    for (const char c : a.name) table.push_back(static_cast<unsigned char>(c));
    table.insert(table.end(), {static_cast<std::uint32_t>(a.type), a.component_count, a.normalized ? 1u : 0u});
  }
}

std::vector<Column> base_chunk(const ProgressiveMesh& mesh) {
  std::vector<Column> columns = base_columns(mesh.attributes);
  add_base_tables(mesh, columns);
  Steps wedge_vertices(columns[kWedgeVertices]), corners(columns[kBaseCorners]);
  for (Index w = 0; w < mesh.base_wedge_count; ++w) wedge_vertices.add(mesh.wedge_vertex[w]);
  for (const FaceGroup& group : mesh.groups)
    for (const Index wedge : group.base_corners) corners.add(wedge);
  Steps x(columns[kBasePositions]), y(columns[kBasePositions + 1]), z(columns[kBasePositions + 2]);
  for (Index v = 0; v < mesh.base_vertex_count; ++v) {
    x.add(ordered_bits(mesh.positions[v].x));
    y.add(ordered_bits(mesh.positions[v].y));
    z.add(ordered_bits(mesh.positions[v].z));
  }
  std::size_t column = kFirstBaseAttribute;
  for (const Attribute& a : mesh.attributes) {
    const OrderedComponents ordered(a.type);
    const std::size_t size = component_bytes(a.type);
    for (std::size_t c = 0; c < a.component_count; ++c, ++column) {
      std::uint32_t last = 0;
      for (std::size_t w = 0; w < mesh.base_wedge_count; ++w) {
        const std::uint32_t value = ordered.load(std::span(a.data).subspan(w * a.element_bytes() + c * size, size));
        columns[column].values.push_back(ordered.residual(value, std::exchange(last, value)));
      }
    }
  }
  return columns;
}

/// Fills the columns of one record chunk after the other, and follows the levels they lead to.
class RecordEncoder {
 public:
  explicit RecordEncoder(const ProgressiveMesh& mesh) : mesh_(mesh), faces_(mesh.groups) {}

  /// Pre: called for consecutive ranges of records.
  Result<std::vector<Column>> encode(Index begin, Index end) {
    columns_ = record_columns(mesh_.attributes);
    add_rounds(begin, end);
    for (Index record = begin; record < end; ++record) {
      LODESTONE_CHECK(add_connectivity(record));
      add_errors(record);
      add_position(record);
      for (std::size_t a = 0, column = kFirstAttribute; a < mesh_.attributes.size(); ++a)
        column = add_attribute(record, mesh_.attributes[a], column);
      faces_.refine(mesh_, record);
    }
    return std::move(columns_);
  }

  std::uint64_t face_count() const {
    std::uint64_t count = 0;
    for (std::size_t g = 0; g < mesh_.groups.size(); ++g) count += faces_.face_count(g);
    return count;
  }

 private:
  void put(std::size_t column, std::uint32_t value) { columns_[column].values.push_back(value); }

  void add_rounds(Index begin, Index end) {
    const auto& rounds = mesh_.round_begin;
    for (std::size_t r = 0; r + 1 < rounds.size(); ++r)
      if (rounds[r] >= begin && rounds[r + 1] <= end && rounds[r] < rounds[r + 1])
        put(kRoundSizes, rounds[r + 1] - rounds[r]);
  }

  Result<void> add_connectivity(Index record) {
    put(kWedgeCounts, mesh_.record_wedge_begin[record + 1] - mesh_.record_wedge_begin[record]);
    put(kSectorCounts, mesh_.sector_begin[record + 1] - mesh_.sector_begin[record]);
    for (Index s = mesh_.sector_begin[record]; s < mesh_.sector_begin[record + 1]; ++s) {
      const SectorHeader& sector = mesh_.sectors[s];
      put(kPolygonSizes, sector.polygon_size);
      put(kGroups, sector.group);
      put(kCentres, 4u * sector.wedge + static_cast<std::uint32_t>(sector.shape));
      if (!add_sector_faces(s))
        return fail(ErrorCode::InvalidArgument,
                    text("stream: record ", record, ": a polygon differs from the faces it covers"));
    }
    return {};
  }

  /// Writes slots and triangles; false where the coarse faces are not those the polygon says.
  bool add_sector_faces(Index s) {
    const SectorHeader& sector = mesh_.sectors[s];
    const std::span polygon(mesh_.polygons.data() + mesh_.polygon_begin[s], sector.polygon_size);
    tracer_.begin(sector.polygon_size);
    for (std::uint64_t i = mesh_.slot_begin(s); i < mesh_.slot_begin(s + 1); ++i) {
      const Index slot = mesh_.slots[i];
      const std::span<const std::uint8_t, 3> triangle(mesh_.triangles.data() + 3 * i, 3);
      if (i == mesh_.slot_begin(s))
        put(kFirstSlots, slot);
      else
        put(kOtherSlots, slot == tracer_.expected_slot(triangle) ? 0 : slot + 1);
      for (const std::uint8_t corner : triangle) put(kTriangles, corner);
      const auto face = faces_.face(sector.group, slot);
      int rotation = tracer_.rotation_of(triangle, face);
      if (rotation == PolygonTracer::kFree) {
        rotation = static_cast<int>(std::find(face.begin(), face.end(), polygon[triangle[0]]) - face.begin());
        put(kRotations, static_cast<std::uint32_t>(rotation));
      }
      if (rotation < 0 || rotation > 2 || !tracer_.trace(triangle, faces_, sector.group, slot, rotation)) return false;
    }
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (tracer_.wedges()[i] == kNoIndex)
        put(kLooseWedges, polygon[i]);
      else if (tracer_.wedges()[i] != polygon[i])
        return false;
    }
    return true;
  }

  void add_errors(Index record) {
    const auto step = [&](std::size_t column, const std::vector<float>& errors) {
      put(column, zigzag(ordered_bits(errors[record + 1]) - ordered_bits(errors[record])));
    };
    step(kDeviations, mesh_.deviation);
    step(kCurvatures, mesh_.curvature_error);
  }

  void add_position(Index record) {
    const Vec3f& p = mesh_.positions[mesh_.base_vertex_count + record];
    const auto predicted = predict_position(mesh_, record);
    put(kPositions, zigzag(ordered_bits(p.x) - predicted[0]));
    put(kPositions + 1, zigzag(ordered_bits(p.y) - predicted[1]));
    put(kPositions + 2, zigzag(ordered_bits(p.z) - predicted[2]));
  }

  /// Returns the column after the attribute's.
  std::size_t add_attribute(Index record, const Attribute& a, std::size_t column) {
    const OrderedComponents ordered(a.type);
    const std::size_t size = component_bytes(a.type);
    const Index first = mesh_.record_wedge_begin[record], end = mesh_.record_wedge_begin[record + 1];
    for (std::size_t c = 0; c < a.component_count; ++c, ++column)
      for (Index w = first; w < end; ++w) {
        const std::uint32_t value = ordered.load(std::span(a.data).subspan(w * a.element_bytes() + c * size, size));
        put(column,
            ordered.residual(value, predict_component(mesh_, record, static_cast<int>(w - first), a, ordered, c)));
      }
    return column;
  }

  const ProgressiveMesh& mesh_;
  FaceReplay faces_;
  PolygonTracer tracer_;
  std::vector<Column> columns_;
};

/// Returns the records at which chunks begin, and record_count() at the end: whole rounds, about `target` records.
std::vector<Index> split_records(const ProgressiveMesh& mesh, std::size_t target) {
  std::vector<Index> bounds{0};
  for (const Index round_end : mesh.round_begin)
    if (round_end - bounds.back() >= target) bounds.push_back(round_end);
  const auto record_count = static_cast<Index>(mesh.record_count());
  if (bounds.back() != record_count) bounds.push_back(record_count);
  return bounds;
}

class StreamWriter {
 public:
  StreamWriter(const ProgressiveMesh& mesh, const StreamOptions& options) : mesh_(mesh), options_(options) {}

  Result<std::vector<std::byte>> write() {
    RecordEncoder encoder(mesh_);
    add_chunk(base_chunk(mesh_), 0, 0, encoder.face_count());
    const std::vector<Index> bounds = split_records(mesh_, std::max<std::size_t>(options_.records_per_chunk, 1));
    for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
      LODESTONE_TRY(const auto columns, encoder.encode(bounds[i], bounds[i + 1]));
      add_chunk(columns, bounds[i], bounds[i + 1], encoder.face_count());
      const double done = static_cast<double>(bounds[i + 1]) / static_cast<double>(bounds.back());
      if (!options_.progress.reach(done)) return cancelled();
    }
    fill_header();
    std::vector<std::byte> out = write_stream_start(start_);
    append_bytes(out, chunk_bytes_);
    return out;
  }

 private:
  void add_chunk(std::span<const Column> columns, Index begin, Index end, std::uint64_t face_count) {
    const CodedChunk coded = encode_columns(columns, options_.zstd_level);
    StreamChunk entry;
    entry.byte_offset = chunk_bytes_.size();  // completed in fill_header
    entry.byte_length = coded.bytes.size();
    entry.decoded_bytes = coded.decoded_bytes;
    entry.checksum = checksum64(coded.bytes);
    entry.record_begin = begin;
    entry.record_count = end - begin;
    entry.face_count = face_count;
    entry.vertex_count = mesh_.base_vertex_count + std::uint64_t{end};
    entry.deviation = mesh_.deviation[end];
    entry.curvature_error = mesh_.curvature_error[end];
    start_.directory.chunks.push_back(entry);
    start_.wedge_counts.push_back(mesh_.record_wedge_begin[end]);
    append_bytes(chunk_bytes_, coded.bytes);
  }

  void fill_header() {
    StreamHeader& h = start_.header;
    auto& chunks = start_.directory.chunks;
    h.header_bytes =
        static_cast<std::uint32_t>(kFixedHeaderBytes + kDirectoryEntryBytes * chunks.size() + kHeaderChecksumBytes);
    h.vertex_count = static_cast<std::uint32_t>(mesh_.vertex_count());
    h.wedge_count = static_cast<std::uint32_t>(mesh_.wedge_vertex.size());
    h.record_count = static_cast<std::uint32_t>(mesh_.record_count());
    for (std::size_t r = 0; r + 1 < mesh_.round_begin.size(); ++r)
      h.round_count += mesh_.round_begin[r] < mesh_.round_begin[r + 1];
    h.base_vertex_count = mesh_.base_vertex_count;
    h.base_wedge_count = mesh_.base_wedge_count;
    h.group_count = static_cast<std::uint32_t>(mesh_.groups.size());
    h.attribute_count = static_cast<std::uint32_t>(mesh_.attributes.size());
    for (StreamChunk& chunk : chunks) chunk.byte_offset += h.header_bytes;
    start_.directory.total_bytes = h.header_bytes + chunk_bytes_.size();
  }

  const ProgressiveMesh& mesh_;
  const StreamOptions& options_;
  StreamStart start_;
  std::vector<std::byte> chunk_bytes_;
};

}  // namespace

Result<std::vector<std::byte>> encode_stream(const ProgressiveMesh& mesh, const StreamOptions& options) {
  if (options.zstd_level < 1 || options.zstd_level > kMaxZstdLevel)
    return fail(ErrorCode::InvalidArgument,
                text("zstd_level is ", options.zstd_level, ", not in 1 to ", kMaxZstdLevel));
  LODESTONE_CHECK(validate(mesh));
  if (!mesh.moves.empty())
    return fail(ErrorCode::Unsupported, "streams of version 2 have no records that move vertices");
  LODESTONE_CHECK(check_limits(mesh));
  return StreamWriter(mesh, options).write();
}

}  // namespace lodestone
