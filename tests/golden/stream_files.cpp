#include "golden/stream_files.h"

#include <algorithm>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include <lodestone/core/assemble.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "stream/stream_layout.h"
#include "stream/stream_records.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

using detail::Column;

ProgressiveMesh simplified(const TriangleSoup& soup, bool vanish = false) {
  SimplifyOptions options;
  options.vanish = vanish;
  return simplify(assemble(soup).value().mesh, options).value().mesh;
}

/// A small sphere with two components of each type, those of whole numbers normalized or not in turns.
TriangleSoup all_types() {
  TriangleSoup soup = icosphere(0, 0.05, 4);
  std::uint32_t value = 1;
  bool normalized = false;
  for (const ComponentType type : {ComponentType::Int8, ComponentType::UInt8, ComponentType::Int16,
                                   ComponentType::UInt16, ComponentType::UInt32, ComponentType::Float32}) {
    normalized = !normalized && type != ComponentType::Float32;
    Attribute attribute{"_A" + std::to_string(static_cast<int>(type)), type, 2, normalized, {}};
    for (std::size_t i = 0; i < soup.positions.size() * attribute.element_bytes(); ++i)
      attribute.data.push_back(static_cast<std::byte>((value = value * 1664525 + 1013904223) >> 24));
    soup.attributes.push_back(std::move(attribute));
  }
  return soup;
}

// Edits.

StreamBytes with_columns(TakenStream stream, std::size_t chunk, const std::function<void(std::vector<Column>&)>& edit) {
  std::vector<Column> columns = stream.columns(chunk);
  edit(columns);
  stream.set_columns(chunk, columns);
  return stream.sealed();
}

/// Edits columns of the base mesh.
auto in_base(std::function<void(std::vector<Column>&)> edit) {
  return [edit = std::move(edit)](TakenStream stream) { return with_columns(std::move(stream), 0, edit); };
}

/// Edits one column of a chunk of records.
auto in_column(std::size_t column, std::function<void(std::vector<std::uint32_t>&)> edit, std::size_t chunk = 1) {
  return [=](TakenStream stream) {
    return with_columns(std::move(stream), chunk, [&](std::vector<Column>& columns) { edit(columns[column].values); });
  };
}

/// Writes the error after record 0 anew; that after record 1 stays. `field`: of the entry, that has what is before.
auto error_after_first(std::size_t column, std::size_t field, float value) {
  return [=](TakenStream stream) {
    const auto before = detail::ordered_bits(stream.get<float>(TakenStream::entry(0, field)));
    const auto edit = [&](std::vector<Column>& columns) {
      std::vector<std::uint32_t>& steps = columns[column].values;
      const std::uint32_t second = before + detail::unzigzag(steps.at(0)) + detail::unzigzag(steps.at(1));
      steps[0] = detail::zigzag(detail::ordered_bits(value) - before);
      steps[1] = detail::zigzag(second - detail::ordered_bits(value));
    };
    return with_columns(std::move(stream), 1, edit);
  };
}

/// Turns the base face that record 0 covers first by one corner, and the rotation by which the record reads it.
StreamBytes face_turned(TakenStream stream) {
  std::vector<Column> base = stream.columns(0), records = stream.columns(1);
  std::vector<std::uint32_t>& steps = base[detail::kBaseCorners].values;
  std::uint32_t last = 0;
  for (std::uint32_t& step : steps) step = last += detail::unzigzag(step);
  const auto face = steps.begin() + 3 * records[detail::kFirstSlots].values.at(0);
  std::rotate(face, face + 1, face + 3);
  last = 0;
  for (std::uint32_t& step : steps) step = detail::zigzag(step - std::exchange(last, step));
  std::uint32_t& rotation = records[detail::kRotations].values.at(0);
  rotation = (rotation + 2) % 3;
  stream.set_columns(0, base);
  stream.set_columns(1, records);
  return stream.sealed();
}

/// Writes the first slot of chunk 1 that is the expected one as any other.
StreamBytes expected_slot_written(TakenStream stream) {
  const ProgressiveMesh mesh = decode_stream(stream.joined()).value();
  std::vector<Index> other_slots;
  for (Index s = 0; s < mesh.sectors.size(); ++s)
    for (std::uint64_t i = mesh.slot_begin(s) + 1; i < mesh.slot_begin(s + 1); ++i)
      other_slots.push_back(mesh.slots[i]);
  return with_columns(std::move(stream), 1, [&](std::vector<Column>& columns) {
    std::vector<std::uint32_t>& codes = columns[detail::kOtherSlots].values;
    const auto first = static_cast<std::size_t>(std::find(codes.begin(), codes.end(), 0) - codes.begin());
    codes.at(first) = other_slots.at(first) + 1;
  });
}

/// Writes a field of the header, or of the directory's entry for chunk 1.
template <class T>
auto header_field(std::size_t at, T value) {
  return [=](TakenStream stream) {
    stream.lay_out().put(at, value);
    return stream.seal().joined();
  };
}
template <class T>
auto entry_field(std::size_t field, T value) {
  return header_field(TakenStream::entry(1, field), value);
}

/// Adds to a field of the header or of the directory.
template <class T>
auto added_to(std::size_t at, T more) {
  return [=](TakenStream stream) {
    stream.lay_out().put(at, static_cast<T>(stream.get<T>(at) + more));
    return stream.seal().joined();
  };
}

/// Writes the first block of chunk 1 anew. `make`: from the bytes that it holds.
auto first_block(std::function<StreamBytes(const StreamBytes&)> make) {
  return [make = std::move(make)](TakenStream stream) {
    std::vector<Column> columns = stream.columns(1);
    const StreamBytes held = planes(columns[0])[0], block = make(held);
    stream.set_columns(1, columns);
    StreamBytes& chunk = stream.chunk(1);
    chunk.erase(chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(stored_block(held).size()));
    chunk.insert(chunk.begin(), block.begin(), block.end());
    return stream.sealed();
  };
}

/// Gives the first column of chunk 1 other bytes.
auto first_column(std::initializer_list<int> bytes) {
  StreamBytes column;
  for (const int byte : bytes) column.push_back(static_cast<std::byte>(byte));
  return first_block([column](const StreamBytes&) { return stored_block(column); });
}

/// Cuts bytes off the end of the stream, or adds some.
auto resized(std::ptrdiff_t more) {
  return [=](const TakenStream& stream) {
    StreamBytes bytes = stream.joined();
    bytes.resize(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(bytes.size()) + more));
    return bytes;
  };
}

auto cut_to(std::size_t size) {
  return [=](const TakenStream& stream) {
    StreamBytes bytes = stream.joined();
    bytes.resize(size);
    return bytes;
  };
}

/// The attribute table of a base chunk, for its edits: length of the first name, its characters, type, components,
/// normalized, then the next.
std::vector<std::uint32_t>& attribute_table(std::vector<Column>& columns) {
  return columns[detail::kAttributeTable].values;
}
std::uint32_t& type_of_first(std::vector<std::uint32_t>& table) { return table[1 + table[0]]; }

StreamBytes grown_header(TakenStream stream) {
  const std::size_t chunks = stream.chunk_count();
  const StreamBytes old = stream.header();
  StreamBytes& header = stream.header();
  const auto unknown = [&](std::size_t count) { header.insert(header.end(), count, std::byte{0xee}); };
  header.assign(old.begin(), old.begin() + 64);
  unknown(8);
  for (std::size_t i = 0; i < chunks; ++i) {
    const auto begin = old.begin() + static_cast<std::ptrdiff_t>(TakenStream::entry(i, 0));
    header.insert(header.end(), begin, begin + 64);
    unknown(16);
  }
  header.resize(header.size() + 8);
  const std::size_t more = header.size() - old.size();
  for (std::size_t i = 0; i < chunks; ++i) {
    const std::size_t at = 64 + 8 + i * (64 + 16);
    stream.put(at, stream.get<std::uint64_t>(at) + more);
  }
  stream.put(10, std::uint16_t{1});
  stream.put(12, static_cast<std::uint32_t>(header.size()));
  stream.put(16, stream.get<std::uint64_t>(16) + more);
  stream.put(60, std::uint16_t{64 + 16});
  return stream.seal().joined();
}

StreamBytes stored_only(TakenStream stream) {
  for (std::size_t i = 0; i < stream.chunk_count(); ++i) stream.set_columns(i, stream.columns(i));
  return stream.sealed();
}

StreamBytes zstd_only(TakenStream stream) {
  for (std::size_t i = 0; i < stream.chunk_count(); ++i) {
    const std::vector<Column> columns = stream.columns(i);
    StreamBytes& chunk = stream.chunk(i);
    chunk.clear();
    for (const Column& column : columns)
      for (const StreamBytes& plane : planes(column)) {
        const StreamBytes block = zstd_block(zstd_frame(plane, plane.size()), plane.size());
        chunk.insert(chunk.end(), block.begin(), block.end());
      }
  }
  return stream.sealed();
}

StreamBytes padded(TakenStream stream) {
  for (std::size_t i = 0; i < stream.chunk_count(); ++i) stream.chunk(i).resize(stream.chunk(i).size() + 5);
  return stream.sealed();
}

std::string hexadecimal(std::uint64_t value) {
  std::ostringstream out;
  out << std::hex << std::setfill('0') << std::setw(16) << value;
  return out.str();
}

/// XXH64 of a level: positions, wedges' vertices, corners, materials and attributes, one after the other.
std::string checksum_of(const Mesh& mesh) {
  StreamBytes all;
  const auto add = [&](const auto& values) {
    const auto bytes = std::as_bytes(std::span(values));
    all.insert(all.end(), bytes.begin(), bytes.end());
  };
  add(mesh.positions), add(mesh.wedge_vertex), add(mesh.corner_wedge), add(mesh.face_material);
  for (const Attribute& attribute : mesh.attributes) add(attribute.name), add(attribute.data);
  return hexadecimal(detail::checksum64(all));
}

}  // namespace

std::vector<EncodedFile> encoded_files() {
  return {
      {"closed", "closed sectors, several chunks", 3, [] { return simplified(icosphere(0, 0.05, 4)); }},
      {"border", "open sectors", 5, [] { return simplified(grid(3, 0.1, 1)); }},
      {"seams", "open and moved sectors, several wedges at a vertex, normals and texture coordinates", 4096,
       [] { return simplified(seam_cube(1)); }},
      {"groups", "two materials", 4, [] { return simplified(two_material_grid(2)); }},
      {"sheets", "sectors of several sheets in one record", 6, [] { return simplified(layered(grid(3, 0.1, 1), 2)); }},
      {"vanished", "an empty base mesh, records without sectors, lone sectors", 2,
       [] { return simplified(tetrahedron(), true); }},
      {"pieces", "pieces that vanish and one that stays", 4096, [] { return simplified(many_components(2)); }},
      {"types", "attributes of every component type, normalized and not", 4, [] { return simplified(all_types()); }},
      {"skinned", "joints and weights", 4096, [] { return simplified(skinned_cylinder(4, 2)); }},
      {"no-records", "a base mesh alone", 4096, [] { return simplified(tetrahedron()); }},
      {"empty", "no vertices", 4096, [] { return simplified(empty_soup()); }},
  };
}

std::vector<EditedFile> valid_edits() {
  return {
      {"later-minor", "closed", "version 2.1, 8 unknown bytes behind the fixed header, 16 behind each entry",
       grown_header},
      {"stored", "seams", "all blocks stored", stored_only},
      {"zstd", "seams", "all blocks zstd frames", zstd_only},
      {"padded", "closed", "5 bytes of padding behind each chunk", padded},
      {"cut", "closed", "cut off after chunk 1",
       [](const TakenStream& stream) {
         StreamBytes bytes = stream.joined();
         bytes.resize(stream.get<std::uint64_t>(TakenStream::entry(2, 0)));
         return bytes;
       }},
  };
}

// One row for each file: a table, however long.
std::vector<EditedFile> breaking_edits() {  // NOLINT(readability-function-size)
  using namespace detail;
  using Values = std::vector<std::uint32_t>;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  return {
      // The fixed header.
      {"no-magic", "closed", "first byte 0", header_field(0, std::uint8_t{0})},
      {"cut-in-fixed-header", "closed", "40 bytes", cut_to(40)},
      {"version-0", "closed", "version_major 0", header_field(8, std::uint16_t{0})},
      {"version-3", "closed", "version_major 3", header_field(8, std::uint16_t{3})},
      {"encoding-2", "closed", "encoding 2", header_field(62, std::uint16_t{2})},
      {"no-groups", "closed", "group_count 0", header_field(52, std::uint32_t{0})},
      {"attributes-65", "closed", "attribute_count 65", header_field(56, std::uint32_t{65})},
      {"no-chunks", "closed", "chunk_count 0", header_field(24, std::uint32_t{0})},
      {"small-entries", "closed", "entry_bytes 63", header_field(60, std::uint16_t{63})},
      {"small-header", "closed", "chunk_count 100", header_field(24, std::uint32_t{100})},
      {"cut-in-directory", "closed", "100 bytes", cut_to(100)},
      {"header-checksum", "closed", "round_count without the checksum made right again",
       [](TakenStream stream) {
         stream.put(40, std::uint32_t{99});
         return stream.joined();
       }},
      {"shorter-than-header", "closed", "total_bytes 64", header_field(16, std::uint64_t{64})},

      // The directory.
      {"gap-of-bytes", "closed", "entry 1: byte_offset 1 more", added_to(TakenStream::entry(1, 0), std::uint64_t{1})},
      {"chunk-too-long", "closed", "entry 1: byte_length 2^40", entry_field(8, std::uint64_t{1} << 40)},
      {"gap-of-records", "closed", "entry 1: record_begin 1", entry_field(32, std::uint32_t{1})},
      {"chunk-without-records", "closed", "entry 1: record_count 0", entry_field(36, std::uint32_t{0})},
      {"expansion", "closed", "entry 1: decoded_bytes 2^40", entry_field(16, std::uint64_t{1} << 40)},
      {"vertices-of-level", "closed", "entry 1: vertex_count 1 more",
       added_to(TakenStream::entry(1, 48), std::uint32_t{1})},
      {"wedges-of-level", "closed", "entry 1: wedge_count 1000", entry_field(52, std::uint32_t{1000})},
      {"error-not-finite", "closed", "entry 1: deviation not a number", entry_field(56, nan)},
      {"counts-of-header", "closed", "record_count 1 more", added_to(36, std::uint32_t{1})},
      {"rounds-of-header", "closed", "round_count 1 more", added_to(40, std::uint32_t{1})},

      // Where chunks lie, and what they lead to.
      {"bytes-behind", "closed", "3 bytes more", resized(3)},
      {"cut-in-chunk", "closed", "3 bytes fewer", resized(-3)},
      {"empty-chunk", "no-records", "chunk 0 of no bytes",
       [](TakenStream stream) {
         stream.chunk(0).clear();
         stream.put(TakenStream::entry(0, 16), std::uint64_t{0});
         return stream.sealed();
       }},
      {"empty-last-chunk", "vanished", "the last chunk of no bytes: no stream cut off before it",
       [](TakenStream stream) {
         const std::size_t last = stream.chunk_count() - 1;
         stream.chunk(last).clear();
         stream.put(TakenStream::entry(last, 16), std::uint64_t{0});
         return stream.sealed();
       }},
      {"chunk-checksum", "closed", "chunk 1: last byte changed without the checksum made right again",
       [](TakenStream stream) {
         stream.chunk(1).back() ^= std::byte{1};
         return stream.joined();
       }},
      {"faces-of-level", "closed", "entry 1: face_count 1 more", added_to(TakenStream::entry(1, 40), std::uint64_t{1})},
      {"deviation-of-level", "closed", "entry 1: deviation 9", entry_field(56, 9.0F)},

      // Blocks.
      {"block-number", "closed", "the first block's decoded_bytes of 11 digits",
       first_block([](const StreamBytes&) { return StreamBytes(12, std::byte{0x80}); })},
      {"block-too-long", "closed", "the first block: a zstd frame of 2^20 bytes",
       first_block([](const StreamBytes& held) {
         StreamBytes block{std::byte{2}};
         append_varint(block, held.size());
         append_varint(block, 1 << 20);
         return block;
       })},
      {"block-over-budget", "closed", "the first block's decoded_bytes 2^20", first_block([](const StreamBytes&) {
         StreamBytes block{std::byte{1}};
         append_varint(block, 1 << 20);
         block.push_back(std::byte{0});
         return block;
       })},
      {"no-last-block", "closed", "chunk 1 without its last block, which is empty or not",
       [](TakenStream stream) {
         std::vector<Column> columns = stream.columns(1);
         columns.back().values.clear();
         stream.set_columns(1, columns);
         stream.chunk(1).resize(stream.chunk(1).size() - 2);
         return stream.sealed();
       }},
      {"block-mode-3", "closed", "the first block: mode 3", first_block([](const StreamBytes& held) {
         StreamBytes block = stored_block(held);
         block[0] = std::byte{3};
         return block;
       })},
      {"zstd-other-size", "closed", "the first block: a zstd frame that states one byte more",
       first_block([](const StreamBytes& held) { return zstd_block(zstd_frame(held, held.size() + 1), held.size()); })},
      {"zstd-cut", "closed", "the first block: a zstd frame without its last byte",
       first_block([](const StreamBytes& held) {
         StreamBytes frame = zstd_frame(held, held.size());
         frame.pop_back();
         return zstd_block(frame, held.size());
       })},
      {"zstd-two-frames", "closed", "the first block: a second zstd frame, of no bytes",
       first_block([](const StreamBytes& held) {
         StreamBytes frames = zstd_frame(held, held.size());
         const StreamBytes none = zstd_frame({}, 0);
         frames.insert(frames.end(), none.begin(), none.end());
         return zstd_block(frames, held.size());
       })},
      {"planes-of-different-sizes", "no-records", "the first plane of the corners in one byte fewer",
       [](TakenStream stream) {
         // All planes in a block of their own, the first one short; decoded_bytes follows.
         const std::vector<Column> columns = stream.columns(0);
         StreamBytes& chunk = stream.chunk(0);
         chunk.clear();
         for (std::size_t i = 0; i < columns.size(); ++i)
           for (std::size_t plane = 0; plane < planes(columns[i]).size(); ++plane) {
             StreamBytes bytes = planes(columns[i])[plane];
             if (i == kBaseCorners && plane == 0) bytes.pop_back();
             const StreamBytes block = stored_block(bytes);
             chunk.insert(chunk.end(), block.begin(), block.end());
           }
         stream.put(TakenStream::entry(0, 16), stream.get<std::uint64_t>(TakenStream::entry(0, 16)) - 1);
         return stream.sealed();
       }},
      {"bytes-missing", "closed", "chunk 1: decoded_bytes 1 more",
       added_to(TakenStream::entry(1, 16), std::uint64_t{1})},
      {"padding-not-zero", "closed", "chunk 1: a byte 1 behind its last block",
       [](TakenStream stream) {
         stream.chunk(1).push_back(std::byte{1});
         return stream.sealed();
       }},
      {"number-too-long", "closed", "the first column: a number of six digits",
       first_column({0x80, 0x80, 0x80, 0x80, 0x80, 0})},
      {"number-too-large", "closed", "the first column: 2^32", first_column({0x80, 0x80, 0x80, 0x80, 0x10})},
      {"number-cut", "closed", "the first column ends inside a number", first_column({1, 0x80})},

      // The base mesh.
      {"name-too-long", "seams", "attribute 0: a name of 256 bytes",
       in_base([](auto& columns) { attribute_table(columns)[0] = 256; })},
      {"name-not-bytes", "seams", "attribute 0: 256 as the first character of its name",
       in_base([](auto& columns) { attribute_table(columns)[1] = 256; })},
      {"component-type", "seams", "attribute 0: component type 5124",
       in_base([](auto& columns) { type_of_first(attribute_table(columns)) = 5124; })},
      {"component-count-0", "seams", "attribute 0: no components",
       in_base([](auto& columns) { (&type_of_first(attribute_table(columns)))[1] = 0; })},
      {"component-count-17", "seams", "attribute 0: 17 components",
       in_base([](auto& columns) { (&type_of_first(attribute_table(columns)))[1] = 17; })},
      {"normalized-2", "seams", "attribute 0: normalized 2",
       in_base([](auto& columns) { (&type_of_first(attribute_table(columns)))[2] = 2; })},
      {"attribute-table-longer", "seams", "a number more in the attribute table",
       in_base([](auto& columns) { attribute_table(columns).push_back(0); })},
      {"attribute-table-shorter", "seams", "a number fewer in the attribute table",
       in_base([](auto& columns) { attribute_table(columns).pop_back(); })},
      {"positions-fewer", "closed", "a number fewer in the column of base positions x",
       in_base([](auto& columns) { columns[kBasePositions].values.pop_back(); })},
      {"wedges-fewer", "closed", "a number fewer in the column of wedges' vertices",
       in_base([](auto& columns) { columns[kWedgeVertices].values.pop_back(); })},
      {"attribute-values-more", "seams", "a number more in the first attribute's column",
       in_base([](auto& columns) { columns[kFirstBaseAttribute].values.push_back(0); })},
      {"wedge-of-no-vertex", "closed", "base wedge 0 at vertex 1000",
       in_base([](auto& columns) { columns[kWedgeVertices].values[0] = zigzag(1000); })},
      {"group-table-longer", "closed", "a number more in the group table",
       in_base([](auto& columns) { columns[kGroupTable].values.push_back(0); })},
      {"group-of-more-faces", "closed", "group 0: 1000 faces",
       in_base([](auto& columns) { columns[kGroupTable].values[1] = 1000; })},
      {"corner-of-no-wedge", "closed", "base corner 0 at wedge 1000",
       in_base([](auto& columns) { columns[kBaseCorners].values[0] = zigzag(1000); })},
      {"corners-of-no-group", "closed", "group 0: one face fewer than there are corners for",
       in_base([](auto& columns) { columns[kGroupTable].values[1] -= 1; })},
      {"base-position-infinite", "no-records", "x of base vertex 0 infinite", in_base([](auto& columns) {
         auto& x = columns[kBasePositions].values;
         const std::uint32_t infinite = ordered_bits(std::numeric_limits<float>::infinity());
         x[1] = zigzag(unzigzag(x[0]) + unzigzag(x[1]) - infinite);  // vertex 1 stays where it is
         x[0] = zigzag(infinite);
       })},
      {"not-canonical", "closed", "the base face that record 0 covers begins with another corner", face_turned},

      // Records.
      {"round-empty", "closed", "round 0: no records", in_column(kRoundSizes, [](Values& v) { v.at(0) = 0; })},
      {"round-too-long", "closed", "round 0: 1000 records", in_column(kRoundSizes, [](Values& v) { v.at(0) = 1000; })},
      {"rounds-missing", "closed", "a round fewer", in_column(kRoundSizes, [](Values& v) { v.pop_back(); })},
      {"value-too-many", "closed", "a number more in the column of first slots",
       in_column(kFirstSlots, [](Values& v) { v.push_back(0); })},
      {"value-too-few", "closed", "a number fewer in the column of positions z",
       in_column(kPositions + 2, [](Values& v) { v.pop_back(); })},
      {"wedges-over-limit", "closed", "record 0: 70000 wedges",
       in_column(kWedgeCounts, [](Values& v) { v.at(0) = 70000; })},
      {"wedges-over-header", "closed", "record 0: more wedges than the header has for all",
       in_column(kWedgeCounts, [](Values& v) { v.at(0) = 100; })},
      {"sectors-too-many", "closed", "record 0: 1000 sectors",
       in_column(kSectorCounts, [](Values& v) { v.at(0) = 1000; })},
      {"polygon-too-small", "closed", "sector 0, closed: 2 corners",
       in_column(kPolygonSizes, [](Values& v) { v.at(0) = 2; })},
      {"polygon-too-large", "closed", "sector 0: 257 corners",
       in_column(kPolygonSizes, [](Values& v) { v.at(0) = 257; })},
      {"lone-too-large", "closed", "sector 0: lone, with the corners of a closed one",
       in_column(kCentres, [](Values& v) { v.at(0) |= 3; })},
      {"no-such-group", "closed", "sector 0: group 1 of 1", in_column(kGroups, [](Values& v) { v.at(0) = 1; })},
      {"no-such-centre", "closed", "sector 0: centre 1 of 1", in_column(kCentres, [](Values& v) { v.at(0) += 4; })},
      {"wedge-of-its-own", "vanished", "the first lone sector's first corner: the wedge that its record makes",
       in_column(
           kLooseWedges, [](Values& v) { v.at(0) = 2; }, 2)},
      {"triangle-order", "closed", "the first triangle 0 0 2",
       in_column(kTriangles, [](Values& v) { v[1] = v.at(0); })},
      {"triangle-outside", "closed", "the first triangle's last corner 200",
       in_column(kTriangles, [](Values& v) { v[2] = 200; })},
      {"no-such-face", "closed", "sector 0: first slot 1000",
       in_column(kFirstSlots, [](Values& v) { v.at(0) = 1000; })},
      {"rotation-3", "closed", "rotation 3", in_column(kRotations, [](Values& v) { v.at(0) = 3; })},
      {"no-expected-face", "closed", "record 1: its second triangle the first again, which nothing lies across",
       in_column(kTriangles, [](Values& v) { std::copy_n(v.begin() + 3, 3, v.begin() + 6); })},
      {"face-contradicts", "closed", "record 1: a second slot whose face has one corner elsewhere",
       in_column(kOtherSlots, [](Values& v) { v.at(0) = 1 + 0; })},
      {"face-elsewhere", "closed", "record 1: a second slot whose face lacks the corner that is known",
       in_column(kOtherSlots, [](Values& v) { v.at(0) = 1 + 1; })},
      {"slot-expected", "closed", "a slot that is the expected one, as slot + 1", expected_slot_written},
      {"deviation-negative", "closed", "deviation after record 0: -1", error_after_first(kDeviations, 56, -1)},
      {"curvature-error-infinite", "closed", "curvature error after record 0: infinite",
       error_after_first(kCurvatures, 60, std::numeric_limits<float>::infinity())},
  };
}

std::string summary_of(std::span<const std::byte> bytes) {
  const auto mesh = decode_stream(bytes);
  if (!mesh) return mesh.error().message;
  const auto directory = read_stream_directory(bytes);
  const Mesh full = extract_level(*mesh, static_cast<Index>(mesh->record_count()));
  std::ostringstream out;
  for (const std::size_t count : {mesh->vertex_count(), mesh->wedge_vertex.size(), full.face_count(),
                                  mesh->record_count(), mesh->round_begin.size() - 1, mesh->sectors.size(),
                                  mesh->groups.size(), mesh->attributes.size(), directory->chunks.size()})
    out << count << '\t';
  out << checksum_of(extract_level(*mesh, 0)) << '\t' << checksum_of(full);
  return out.str();
}

}  // namespace lodestone::test
