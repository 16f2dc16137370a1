#include "scene/draco_levels.h"

#include <utility>

#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>

#include "gltf/draco_check.h"

namespace lodestone::detail {
namespace {

/// What of a primitive goes into Draco data, and what to ask of it to get it back.
struct DracoInput {
  Mesh mesh;
  QuantizationGrids grids;
  std::vector<DracoRequest> requests;  ///< positions first
};

/// Morph targets stay out of it.
DracoInput input_of(const LevelToEncode& level, const FacesOfMaterial& group) {
  const SourcePrimitive& primitive = level.source->primitives[group.material];
  DracoInput input{{}, {level.grids->position, {}}, {{0, ComponentType::Float32, 3, false}}};
  std::vector<const Attribute*> attributes;
  for (const std::size_t column : primitive.columns) {
    if (level.source->columns[column].target) continue;
    const Attribute& a = *level.level->columns[column];
    attributes.push_back(&a);
    input.grids.attributes.push_back(level.grids->attributes[column]);
    input.requests.push_back({0, a.type, a.component_count, a.normalized});
  }
  input.mesh = submesh(*level.level->mesh, group.corner_wedge, attributes);
  return input;
}

Result<DracoOutput> encode(const DracoInput& input, const DracoCoding& coding, int compression_level) {
  DracoOutput output;
  LODESTONE_TRY(output.encoded, encode_draco(input.mesh, input.grids, coding, compression_level));
  std::vector<DracoRequest> requests = input.requests;
  requests[0].unique_id = output.encoded.position_id;
  for (std::size_t i = 1; i < requests.size(); ++i) requests[i].unique_id = output.encoded.attribute_ids[i - 1];
  LODESTONE_TRY(output.decoded, decode_draco(output.encoded.bytes, requests, "encoded level"));
  LODESTONE_CHECK(check_decoded(output.decoded, input.mesh, input.grids));
  return output;
}

/// Targets must be in the order of the decoded points. A decoder that reorders them leaves only the plain form.
Result<DracoOutput> encode_in_order(const DracoInput& input, int compression_level) {
  LODESTONE_TRY(DracoOutput output,
                encode(input, {DracoMethod::Sequential, DracoPrediction::Neighbours}, compression_level));
  if (output.decoded.indices == input.mesh.corner_wedge) return output;
  return fail(ErrorCode::Unsupported, "Draco: the points are decoded in another order");
}

/// Tries one way after the other; returns the last one's error where all fail.
Result<DracoOutput> encode_smallest(const DracoInput& input, int compression_level) {
  constexpr DracoCoding kCodings[] = {{DracoMethod::Edgebreaker, DracoPrediction::Positions},
                                      {DracoMethod::Edgebreaker, DracoPrediction::Neighbours},
                                      {DracoMethod::Sequential, DracoPrediction::Neighbours}};
  Result<DracoOutput> output;
  for (const DracoCoding& coding : kCodings)
    if (output = encode(input, coding, compression_level); output) break;
  return output;
}

Result<DracoOutput> encode_group(const LevelToEncode& level, const FacesOfMaterial& group, int compression_level) {
  const DracoInput input = input_of(level, group);
  const bool in_order = level.source->primitives[group.material].target_count > 0;
  return in_order ? encode_in_order(input, compression_level) : encode_smallest(input, compression_level);
}

}  // namespace

std::vector<EncodedLevel> encode_levels(std::span<const LevelToEncode> levels, const AssetOptions& options,
                                        const Progress& progress) {
  std::vector<EncodedLevel> encoded(levels.size());
  for_each_in_parallel(levels.size(),
                       [&](std::size_t i) { encoded[i].groups = split_by_material(*levels[i].level->mesh); });
  if (options.compression != Compression::Draco) return encoded;
  std::vector<std::pair<std::size_t, std::size_t>> jobs;  // level and group
  for (std::size_t level = 0; level < levels.size(); ++level) {
    encoded[level].outputs.resize(encoded[level].groups.size());
    for (std::size_t group = 0; group < encoded[level].groups.size(); ++group) jobs.emplace_back(level, group);
  }
  for_each_in_parallel(jobs.size(), [&](std::size_t i) {
    if (progress.is_cancelled()) return;
    const auto [level, group] = jobs[i];
    encoded[level].outputs[group] =
        encode_group(levels[level], encoded[level].groups[group], options.draco_compression_level);
    progress.add(1 / static_cast<double>(jobs.size()));
  });
  return encoded;
}

}  // namespace lodestone::detail
