#include "model/write_model.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <new>
#include <ostream>
#include <span>
#include <streambuf>
#include <tuple>

#include <lodestone/core/detail/text.h>

#include "base/bytes.h"
#include "base/json.h"
#include "model/model_depth.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kJsonStart = 20;  // after the header and the first chunk's length and type

/// A stream's end that appends to bytes.
class ByteSink : public std::streambuf {
 public:
  explicit ByteSink(std::vector<std::byte>& out) : out_(out) {}

 protected:
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    append_bytes(out_, std::as_bytes(std::span(text, static_cast<std::size_t>(size))));
    return size;
  }
  int_type overflow(int_type c) override {
    if (!traits_type::eq_int_type(c, traits_type::eof())) out_.push_back(static_cast<std::byte>(c));
    return traits_type::not_eof(c);
  }

 private:
  std::vector<std::byte>& out_;
};

/// tinygltf's versions disagree on what stands between `embed` and the last two arguments.
const auto kNameImage = [](const std::string*, const std::string*, const tinygltf::Image* image, bool /*embed*/,
                           auto... rest) {
  const auto arguments = std::make_tuple(rest...);
  std::string* uri = std::get<sizeof...(rest) - 2>(arguments);
  *uri = image->uri.empty() ? "data:," : image->uri;
  return true;
};

/// tinygltf writes an object without members as null, which glTF has no place for: "{}" and two blanks are as long. A
/// list of animations that all have no channels it writes as null, too; that goes, with its name and the comma after
/// it.
void mend_empty_objects(std::span<char> json) {
  constexpr std::string_view kNoAnimations = "\"animations\":null,", kNull = "null", kEmpty = "{}  ";
  bool in_string = false;
  int depth = 0;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const auto at = json.begin() + static_cast<std::ptrdiff_t>(i);
    const std::string_view rest(json.data() + i, json.size() - i);
    if (in_string && json[i] == '\\') {
      ++i;
    } else if (!in_string && depth == 1 && rest.starts_with(kNoAnimations)) {
      std::fill_n(at, kNoAnimations.size(), ' ');
    } else if (json[i] == '"') {
      in_string = !in_string;
    } else if (!in_string) {
      if (rest.starts_with(kNull)) std::copy(kEmpty.begin(), kEmpty.end(), at);
      depth += json[i] == '{' || json[i] == '[' ? 1 : json[i] == '}' || json[i] == ']' ? -1 : 0;
    }
  }
}

Result<void> check_size(const tinygltf::Model& model) {
  std::uint64_t size = 0;
  for (const tinygltf::Buffer& buffer : model.buffers) size += buffer.data.size();
  if (size <= std::numeric_limits<std::uint32_t>::max()) return {};
  return fail(ErrorCode::LimitExceeded, text("glb: ", size, " bytes are more than the format can hold"));
}

Result<std::vector<std::byte>> write_unchecked(const tinygltf::Model& model) {
  std::vector<std::byte> glb;
  ByteSink sink(glb);
  std::ostream stream(&sink);
  tinygltf::TinyGLTF writer;
  writer.SetImageWriter(kNameImage, nullptr);
  if (!writer.WriteGltfSceneToStream(&model, stream, false, true) || !stream)
    return fail(ErrorCode::Malformed, "tinygltf does not write the model");
  return glb;
}

}  // namespace

Result<std::vector<std::byte>> write_model(const tinygltf::Model& model) {
  if (nests_deeper(model, kMaxJsonDepth))
    return fail(ErrorCode::LimitExceeded, text("model: extras or extensions nest deeper than ", kMaxJsonDepth));
  if (auto checked = check_size(model); !checked) return tl::unexpected(checked.error());
  Result<std::vector<std::byte>> glb;
  try {
    glb = write_unchecked(model);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return fail(ErrorCode::Malformed, text("model: ", error.what()));
  }
  if (!glb) return glb;
  // Its sizes are of 32 bits, and JSON has no bound: what they say must be what there is.
  if (glb->size() < kJsonStart || load_u32(*glb, 8) != glb->size())
    return fail(ErrorCode::LimitExceeded, text("glb: ", glb->size(), " bytes are more than the format can hold"));
  const std::size_t json_size = load_u32(*glb, 12);
  mend_empty_objects({reinterpret_cast<char*>(glb->data()) + kJsonStart, json_size});
  return glb;
}

std::string as_utf8(std::string_view text) {
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(quoted).get<std::string>();
}

}  // namespace lodestone::detail
