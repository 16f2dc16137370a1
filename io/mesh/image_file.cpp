#include "mesh/image_file.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <lodestone/core/detail/text.h>

#include "base/bytes.h"
#include "base/files_beside.h"

namespace lodestone::detail {
namespace {

using namespace std::string_view_literals;

struct ImageType {
  std::string_view magic;
  std::size_t at;
  const char* mime_type;
};

constexpr std::array<ImageType, 7> kImageTypes = {{{"\x89PNG\r\n\x1a\n"sv, 0, "image/png"},
                                                   {"\xff\xd8\xff"sv, 0, "image/jpeg"},
                                                   {"WEBP"sv, 8, "image/webp"},
                                                   {"\xabKTX 20\xbb\r\n\x1a\n"sv, 0, "image/ktx2"},
                                                   {"ftypavif"sv, 4, "image/avif"},
                                                   {"DDS "sv, 0, "image/vnd-ms.dds"},
                                                   {"sB"sv, 0, "image/x-basis"}}};

constexpr std::size_t kPngColorType = 25;
constexpr std::byte kPngColorBit{2};

std::uint8_t byte_at(std::span<const std::byte> bytes, std::size_t at) {
  return at < bytes.size() ? std::to_integer<std::uint8_t>(bytes[at]) : 0;
}

/// Returns the number of components that a JPEG's frame header states; 0 where there is none.
int jpeg_components(std::span<const std::byte> bytes) {
  for (std::size_t at = 2; at + 9 < bytes.size() && byte_at(bytes, at) == 0xff;) {
    const int marker = byte_at(bytes, at + 1);
    const bool is_table = marker == 0xc4 || marker == 0xc8 || marker == 0xcc;
    if (marker >= 0xc0 && marker <= 0xcf && !is_table) return byte_at(bytes, at + 9);
    at += std::size_t{2} + byte_at(bytes, at + 2) * 256u + byte_at(bytes, at + 3);
  }
  return 0;
}

bool is_inside(const std::filesystem::path& path) {
  return !path.empty() && path.is_relative() && path.string().find(':') == std::string::npos &&
         std::find(path.begin(), path.end(), "..") == path.end();
}

}  // namespace

std::string image_type(std::span<const std::byte> bytes) {
  const std::string_view start = as_text(bytes).substr(0, 16);
  for (const ImageType& type : kImageTypes)
    if (start.size() >= type.at && start.substr(type.at).starts_with(type.magic)) return type.mime_type;
  return "";
}

bool is_grey(const Image& image) {
  if (image.mime_type == "image/jpeg") return jpeg_components(image.bytes) == 1;
  return image.bytes.size() > kPngColorType && (image.bytes[kPngColorType] & kPngColorBit) == std::byte{0};
}

std::string tidy_path(std::string_view name) {
  constexpr std::string_view kAround = " \t\v\f\r\"";
  const std::size_t first = name.find_first_not_of(kAround);
  if (first == name.npos) return "";
  std::string path(name.substr(first, name.find_last_not_of(kAround) - first + 1));
  std::replace(path.begin(), path.end(), '\\', '/');
  return path;
}

Result<std::vector<std::byte>> fetch_named(const FileFetcher& fetch, const std::string& name,
                                           const std::filesystem::path& folder) {
  const std::filesystem::path path = (folder / name).lexically_normal();
  auto found =
      is_inside(path) ? fetch(path) : fail(ErrorCode::Unsupported, "it is not beside or below the mesh's file");
  const std::filesystem::path beside = path.filename();
  if (found || beside == path || !is_inside(beside)) return found;
  auto fetched = fetch(beside);
  return fetched ? std::move(fetched) : std::move(found);
}

std::optional<std::size_t> ImageLoader::load(std::string_view name, const std::filesystem::path& folder) {
  const std::string path = tidy_path(name);
  if (path.empty()) return std::nullopt;
  const auto [entry, is_new] = loaded_.try_emplace((folder / path).string());
  if (is_new) entry->second = fetch(path, folder);
  return entry->second;
}

std::optional<std::size_t> ImageLoader::fetch(const std::string& name, const std::filesystem::path& folder) {
  auto bytes = fetch_named(fetch_, name, folder);
  if (!bytes) {
    file_.notes.push_back(text("texture '", name, "' is left out: ", bytes.error().message));
    return std::nullopt;
  }
  std::string type = image_type(*bytes);
  if (type != "image/png" && type != "image/jpeg") {
    file_.notes.push_back(text("texture '", name, "' is left out: it is neither PNG nor JPEG, which glTF asks for"));
    return std::nullopt;
  }
  file_.images.push_back({name, std::move(type), std::move(*bytes)});
  return file_.images.size() - 1;
}

}  // namespace lodestone::detail
