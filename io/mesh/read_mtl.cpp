// Material libraries of Wavefront OBJ, after the format's description of 1995 and the statements for physically based
// rendering that exporters have added since (Pr, Pm, norm …), in glTF's metallic-roughness model.
//
// What is a convention here: Kd and Ke are taken as linear, as they are by Blender, Assimp and obj2gltf. Ka and Ni say
// nothing that glTF's light does not. The exponent n of a highlight, Ns, is Blinn and Phong's: a Beckmann distribution
// of α = √(2 / (n + 2)) is as wide (B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007),
// and glTF's roughness is √α; without a highlight it is 1. A bump map may hold heights, as it was meant to, or normals,
// as exporters of today write it: grey images are heights, for which glTF has no place.

#include "mesh/read_mtl.h"
#include "base/bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <lodestone/core/detail/text.h>

#include "base/number_text.h"

namespace lodestone::detail {
namespace {

using Rgb = std::array<float, 3>;

constexpr std::size_t kMostNamed = 5;

/// An option of a map statement and how many arguments it has at most; those of vectors may be fewer.
struct MapOption {
  std::string_view name;
  std::size_t arguments;
};
constexpr std::array<MapOption, 13> kMapOptions = {{{"-blendu", 1},
                                                    {"-blendv", 1},
                                                    {"-bm", 1},
                                                    {"-boost", 1},
                                                    {"-cc", 1},
                                                    {"-clamp", 1},
                                                    {"-imfchan", 1},
                                                    {"-mm", 2},
                                                    {"-o", 3},
                                                    {"-s", 3},
                                                    {"-t", 3},
                                                    {"-texres", 1},
                                                    {"-type", 1}}};

const MapOption* find_option(std::string_view name) {
  const auto* found =
      std::find_if(kMapOptions.begin(), kMapOptions.end(), [&](const MapOption& o) { return o.name == name; });
  return found == kMapOptions.end() ? nullptr : &*found;
}

/// A statement that names an image.
struct MapStatement {
  std::string file;
  std::array<float, 3> scale{1, 1, 1};
  std::array<float, 3> offset{0, 0, 0};
  bool clamp = false;
  float multiplier = 1;  ///< of bumps

  /// OBJ's v points up: v' = s·v + o becomes 1 − v' = s·(1 − v) + (1 − s − o).
  Texture texture(std::size_t image) const {
    return {image, {scale[0], scale[1]}, {offset[0], 1 - scale[1] - offset[1]}, clamp};
  }
};

void read_vector(std::string_view& rest, std::array<float, 3>& out) {
  for (float& component : out) {
    std::string_view after = rest;
    const auto value = parse_float(next_token(after));
    if (!value) return;
    component = *value;
    rest = after;
  }
}

void read_option(const MapOption& option, std::string_view& rest, MapStatement& map) {
  if (option.name == "-s") return read_vector(rest, map.scale);
  if (option.name == "-o") return read_vector(rest, map.offset);
  std::array<float, 3> ignored{};
  if (option.name == "-t") return read_vector(rest, ignored);
  for (std::size_t i = 0; i < option.arguments; ++i) {
    const std::string_view argument = next_token(rest);
    if (option.name == "-clamp") map.clamp = argument == "on";
    if (option.name == "-bm") map.multiplier = parse_float(argument).value_or(1);
  }
}

void read_options(std::string_view& rest, MapStatement& map) {
  for (;;) {
    std::string_view after = rest;
    const MapOption* option = find_option(next_token(after));
    if (option == nullptr) return;
    rest = after;
    read_option(*option, rest, map);
  }
}

/// Returns where a name ends: before an option that stands behind it, as some exporters have it.
std::size_t end_of_name(std::string_view words) {
  std::size_t end = words.size();
  for (const MapOption& option : kMapOptions) {
    end = std::min(end, words.find(text(' ', option.name, ' ')));
  }
  return end;
}

MapStatement parse_map(std::string_view arguments) {
  MapStatement map;
  read_options(arguments, map);
  const std::size_t end = end_of_name(arguments);
  map.file = tidy_path(arguments.substr(0, end));
  arguments.remove_prefix(end);
  read_options(arguments, map);
  return map;
}

/// "r g b", or "r" for grey. Nothing for spectral curves and CIE's colours.
std::optional<Rgb> parse_color(std::string_view arguments) {
  Rgb color{};
  std::size_t count = 0;
  for (std::string_view token; count < 3 && !(token = next_token(arguments)).empty(); ++count) {
    const auto value = parse_float(token);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    color[count] = *value;
  }
  if (count == 0) return std::nullopt;
  if (count == 1) color[1] = color[2] = color[0];
  return color;
}

/// The last word is the number; "-halo" may stand before it.
std::optional<float> parse_last_number(std::string_view arguments) {
  std::optional<float> number;
  for (std::string_view token; !(token = next_token(arguments)).empty();) number = parse_float(token);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

bool is_black(const Rgb& color) { return color[0] <= 0 && color[1] <= 0 && color[2] <= 0; }

Rgb clamped(Rgb color, float most) {
  for (float& component : color) component = std::clamp(component, 0.0F, most);
  return color;
}

float roughness_of_exponent(float exponent) {
  return static_cast<float>(std::sqrt(std::sqrt(2.0 / (std::max(0.0, static_cast<double>(exponent)) + 2.0))));
}

std::string list_of(const auto& words) {
  std::string out;
  std::size_t count = 0;
  for (const std::string& word : words) {
    if (count++ == kMostNamed) return out + " …";
    if (!out.empty()) out += ", ";
    out += word;
  }
  return out;
}

}  // namespace

std::string_view trimmed(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\v\f\r";
  const std::size_t first = line.find_first_not_of(kBlanks);
  return first == line.npos ? std::string_view() : line.substr(first, line.find_last_not_of(kBlanks) - first + 1);
}

std::string_view without_comment(std::string_view line) {
  for (std::size_t at = line.find('#'); at != line.npos; at = line.find('#', at + 1))
    if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') return line.substr(0, at);
  return line;
}

/// Makes glTF's material of one entry.
class MaterialLibraries::Converter {
 public:
  Converter(MaterialLibraries& libraries, const Entry& entry) : libraries_(libraries), entry_(entry) {}

  Material run(const std::string& name) {
    material_.name = name;
    convert_base_color();
    convert_surface();
    convert_emission();
    convert_normals();
    for (const auto& [key, statement] : entry_.statements)
      if (!used_.contains(key) && !is_neutral(key, statement.arguments)) libraries_.left_out_.insert(statement.keyword);
    return material_;
  }

 private:
  const std::string* arguments(const char* key) {
    const auto found = entry_.statements.find(key);
    if (found == entry_.statements.end()) return nullptr;
    used_.insert(key);
    return &found->second.arguments;
  }
  std::optional<Rgb> color(const char* key) {
    const std::string* text = arguments(key);
    return text == nullptr ? std::nullopt : parse_color(*text);
  }
  std::optional<float> number(const char* key) {
    const std::string* text = arguments(key);
    return text == nullptr ? std::nullopt : parse_last_number(*text);
  }
  std::optional<MapStatement> map(const char* key) {
    const std::string* text = arguments(key);
    return text == nullptr ? std::nullopt : std::optional(parse_map(*text));
  }
  std::optional<Texture> load(const MapStatement& statement) {
    const auto image = libraries_.images_.load(statement.file, entry_.folder);
    return image ? std::optional(statement.texture(*image)) : std::nullopt;
  }
  void leave_out(const char* key) { used_.erase(key); }

  /// Exporters write statements that say nothing: no coat, all light passes, a coat's roughness without a coat.
  bool is_neutral(std::string_view key, std::string_view arguments) const {
    const auto coat = entry_.statements.find("pc");
    if (key == "pcr" && (coat == entry_.statements.end() || is_neutral("pc", coat->second.arguments))) return true;
    const auto values = parse_color(arguments);
    const float nothing = key == "tf" ? 1 : 0;
    return values && std::all_of(values->begin(), values->end(), [&](float v) { return v == nothing; });
  }

  /// A black Kd below a texture is an exporter's way to say nothing: taken at its word it would hide the texture.
  void convert_base_color() {
    const auto diffuse = color("kd"), ambient = color("ka");
    const auto image = map("map_kd"), alpha = map("map_d"), ambient_image = map("map_ka");
    if (image) material_.base_color_texture = load(*image);
    const bool textured = material_.base_color_texture.has_value();
    Rgb base = diffuse ? *diffuse : ambient && !textured ? *ambient : Rgb{1, 1, 1};
    if (textured && is_black(base)) base = {1, 1, 1};
    base = clamped(base, 1);
    std::copy(base.begin(), base.end(), material_.base_color.begin());
    const auto opacity = number("d"), transparency = number("tr");
    material_.base_color[3] = std::clamp(opacity ? *opacity : 1 - transparency.value_or(0), 0.0F, 1.0F);
    const bool shares_alpha = alpha && image && alpha->file == image->file;
    if (alpha && !shares_alpha) leave_out("map_d");
    if (ambient_image && !(image && ambient_image->file == image->file)) leave_out("map_ka");
    material_.translucent = material_.base_color[3] < 1 || (shares_alpha && textured);
  }

  void convert_surface() {
    const auto roughness = number("pr"), metallic = number("pm"), exponent = number("ns"), model = number("illum");
    const auto highlight = color("ks");
    arguments("ni");
    if (highlight && (highlight->at(0) != highlight->at(1) || highlight->at(1) != highlight->at(2))) leave_out("ks");
    const bool matte = (highlight && is_black(*highlight)) || (model && *model < 2);
    if (matte)
      material_.roughness = 1;
    else if (exponent)
      material_.roughness = roughness_of_exponent(*exponent);
    if (roughness) material_.roughness = std::clamp(*roughness, 0.0F, 1.0F);
    if (metallic) material_.metallic = std::clamp(*metallic, 0.0F, 1.0F);
    convert_surface_maps(roughness.has_value(), metallic.has_value());
  }

  /// glTF has both in one image. A grey one of roughness will do where nothing is metallic.
  void convert_surface_maps(bool has_roughness, bool has_metallic) {
    const auto rough = map("map_pr"), metal = map("map_pm");
    if (rough && metal && rough->file == metal->file) {
      material_.metallic_roughness_texture = load(*rough);
      if (!has_metallic) material_.metallic = 1;
    } else if (rough && !metal && material_.metallic == 0) {
      material_.metallic_roughness_texture = load(*rough);
    } else {
      leave_out("map_pr");
      leave_out("map_pm");
    }
    if (material_.metallic_roughness_texture && !has_roughness) material_.roughness = 1;
  }

  void convert_emission() {
    const auto light = color("ke");
    const auto image = map("map_ke");
    if (image) material_.emissive_texture = load(*image);
    Rgb emissive = light.value_or(Rgb{});
    if (material_.emissive_texture && is_black(emissive)) emissive = {1, 1, 1};
    material_.emissive = clamped(emissive, 1e6F);
  }

  void convert_normals() {
    const auto normals = map("norm");
    const char* bump_key = entry_.statements.contains("map_bump") ? "map_bump" : "bump";
    const auto bumps = map(bump_key);
    if (normals) material_.normal_texture = load(*normals);
    if (!bumps || material_.normal_texture) return;
    const auto texture = load(*bumps);
    if (!texture) return;
    if (is_grey(libraries_.file_.images[texture->image])) {
      leave_out(bump_key);
      return;
    }
    material_.normal_texture = texture;
    material_.normal_scale = bumps->multiplier;
    libraries_.bumps_.insert(bumps->file);
  }

  MaterialLibraries& libraries_;
  const Entry& entry_;
  std::set<std::string> used_{"newmtl"};
  Material material_;
};

void MaterialLibraries::add(std::string_view names) {
  const std::string whole = tidy_path(names);
  if (whole.empty() || add_library(whole, true)) return;
  std::string name;
  bool several = false;
  for (std::string_view token; !(token = next_token(names)).empty();) {
    if (!name.empty()) name += ' ';
    name += token;
    if (!lower_case(name).ends_with(".mtl") || trimmed(names).empty()) continue;
    add_library(tidy_path(name), false);
    name.clear();
    several = true;
  }
  add_library(several ? tidy_path(name) : whole, false);
}

bool MaterialLibraries::add_library(const std::string& name, bool may_lack) {
  const auto bytes = fetch_named(fetch_, name, "");
  if (bytes) {
    parse(without_byte_order_mark(as_text(*bytes)), std::filesystem::path(name).parent_path());
  } else if (!may_lack) {
    file_.notes.push_back(text("material library '", name, "' is left out: ", bytes.error().message));
  }
  return bytes.has_value();
}

void MaterialLibraries::parse(std::string_view rest, const std::filesystem::path& folder) {
  Entry* entry = nullptr;
  while (!rest.empty()) {
    std::string_view line = without_comment(next_line(rest));
    const std::string_view keyword = next_token(line);
    if (keyword.empty()) continue;
    const std::string key = lower_case(keyword);
    if (key == "newmtl") {
      entry = &entries_[std::string(trimmed(line))];
      *entry = {folder, {}};
    } else if (entry != nullptr) {
      entry->statements[key] = {std::string(keyword), std::string(trimmed(line))};
    }
  }
}

Material MaterialLibraries::material(const std::string& name) {
  const auto found = entries_.find(name);
  if (found != entries_.end()) return Converter(*this, found->second).run(name);
  unknown_.push_back(text('\'', name, '\''));
  Material plain;
  plain.name = name;
  return plain;
}

void MaterialLibraries::finish() {
  if (!unknown_.empty())
    file_.notes.push_back(text("materials that no library at hand describes are plain: ", list_of(unknown_)));
  if (!bumps_.empty())
    file_.notes.push_back(text("bump maps in colour are taken for maps of normals: ", list_of(bumps_)));
  if (!left_out_.empty())
    file_.notes.push_back(
        text("statements of materials that glTF has no place for are left out: ", list_of(left_out_)));
}

}  // namespace lodestone::detail
