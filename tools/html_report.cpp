#include "html_report.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "colour_map.h"
#include "error_map.h"
#include "html_assets.h"
#include "page_geometry.h"

namespace lodestone::tool {
namespace {

using detail::text;

constexpr std::size_t kMostFacesOfMesh = 200'000;
constexpr std::size_t kMostFacesOfPage = 1'000'000;
constexpr std::size_t kColourStops = 33;

/// Returns the mesh without attributes and materials.
Mesh bare(const Mesh& mesh) {
  Mesh out;
  out.positions = mesh.positions;
  for (Index v = 0; v < mesh.vertex_count(); ++v) out.wedge_vertex.push_back(v);
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) out.corner_wedge.push_back(mesh.corner_vertex(c));
  return out;
}

/// Returns the mesh with no more faces than a page should hold, if that can be had; its vertices are the mesh's.
Result<Mesh> picture_of(const Mesh& mesh, std::size_t most_faces) {
  if (mesh.face_count() <= most_faces) return bare(mesh);
  SimplifyOptions options;
  options.measure_step = 0;
  options.stop.min_faces = most_faces - 2;
  LODESTONE_TRY(const SimplifyResult simplified, simplify(bare(mesh), options));
  return extract_level(simplified.mesh, position_for_faces(simplified.mesh, most_faces));
}

Box box_around(const std::vector<Mesh>& meshes) {
  Box all = bounding_box(meshes.front());
  for (const Mesh& mesh : meshes) {
    if (mesh.face_count() == 0) continue;
    const Box box = bounding_box(mesh);
    all.low = {std::min(all.low.x, box.low.x), std::min(all.low.y, box.low.y), std::min(all.low.z, box.low.z)};
    all.high = {std::max(all.high.x, box.high.x), std::max(all.high.y, box.high.y), std::max(all.high.z, box.high.z)};
  }
  return all;
}

/// Returns the text with some of its characters spelt otherwise.
std::string respelt(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> spellings) {
  std::string out;
  for (const char& c : text) {
    std::string_view spelling(&c, 1);
    for (const auto& [character, other] : spellings)
      if (character == c) spelling = other;
    out += spelling;
  }
  return out;
}

std::string escaped(std::string_view text) {
  return respelt(text, {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}});
}

/// JSON that may stand in a <script>: no tag can begin or end within it.
std::string script_json(const Json& json) {
  return respelt(json.dump(-1, ' ', false, nlohmann::detail::error_handler_t::replace),
                 {{'<', "\\u003c"}, {'>', "\\u003e"}, {'&', "\\u0026"}});
}

/// Collects what the page embeds: small things as JSON, geometry and errors as scripts of their own that are read
/// later.
class PageData {
 public:
  std::string add_blob(std::span<const std::byte> bytes) {
    std::string id = text("blob-", blob_count_++);
    blobs_ += "<script type=\"text/plain\" id=\"" + id + "\">" + base64(bytes) + "</script>\n";
    return id;
  }
  const std::string& blobs() const { return blobs_; }

 private:
  std::string blobs_;
  std::size_t blob_count_ = 0;
};

Json spread_json(const ErrorSpread& spread) {
  Json bins = Json::array();
  for (const double share : spread.bins) bins.push_back(std::round(share * 1e6) / 1e6);
  return {{"max", spread.maximum},
          {"p50", spread.median},
          {"p90", spread.most},
          {"p99", spread.nearly_all},
          {"bins", std::move(bins)}};
}

/// The original's errors against one of the other meshes; null where there is nothing to measure against.
Json errors_json(const Mesh& original, const Mesh& picture, std::span<const Index> order, const Mesh& other,
                 PageData& data) {
  const SurfaceIndex surface(other);
  if (surface.empty()) return nullptr;
  const std::vector<float> errors = vertex_errors(picture, surface);
  const double largest = errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
  const ErrorSpread spread = measure_spread(original, surface, largest);
  Json json = spread_json(spread);
  json["data"] = data.add_blob(encode_errors(errors, spread.maximum, order));
  return json;
}

Result<Json> pictures_json(const std::vector<Mesh>& meshes, const Box& box, PageData& data) {
  const std::size_t most_faces = std::min(kMostFacesOfMesh, kMostFacesOfPage / meshes.size());
  std::optional<Mesh> original;
  std::vector<Index> order;
  Json json = Json::array();
  for (const Mesh& mesh : meshes) {
    LODESTONE_TRY(Mesh picture, picture_of(mesh, most_faces));
    PageGeometry geometry = encode_geometry(picture, box);
    Json entry = {{"faces", mesh.face_count()}, {"shown_faces", picture.face_count()}};
    entry["data"] = data.add_blob(geometry.bytes);
    entry["errors"] = original ? errors_json(meshes.front(), *original, order, mesh, data) : Json(nullptr);
    if (!original) original = std::move(picture), order = std::move(geometry.vertices);
    json.push_back(std::move(entry));
  }
  return json;
}

/// Returns the template with each `{{name}}` replaced; what is put in is not looked at again.
std::string filled(std::string_view page, const std::vector<std::pair<std::string_view, std::string_view>>& values) {
  std::string out;
  while (true) {
    const std::size_t begin = page.find("{{"), end = page.find("}}", begin);
    out += page.substr(0, begin);
    if (begin == page.npos || end == page.npos) return out;
    const std::string_view name = page.substr(begin + 2, end - begin - 2);
    for (const auto& [key, value] : values)
      if (key == name) out += value;
    page.remove_prefix(end + 2);
  }
}

}  // namespace

Result<std::string> html_page(const HtmlReport& report) {
  PageData data;
  const Box box = box_around(report.meshes);
  LODESTONE_TRY(Json pictures, pictures_json(report.meshes, box, data));
  const Json page = {{"title", report.title},
                     {"diagonal", report.diagonal},
                     {"box", box_json(box)},
                     {"colours", colour_stops(kColourStops)},
                     {"pictures", std::move(pictures)},
                     {"numbers", report.numbers}};
  return filled(html::kPage, {{"title", escaped(report.title)},
                              {"version", LODESTONE_VERSION},
                              {"style", html::kStyle},
                              {"data", script_json(page)},
                              {"blobs", data.blobs()},
                              {"geometry", html::kGeometry},
                              {"viewer", html::kViewer},
                              {"charts", html::kCharts},
                              {"page", html::kMain}});
}

}  // namespace lodestone::tool
