#include "mesh/soup_pack.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/bytes.h"

namespace lodestone::detail {
namespace {

/// Both directions go through the same list of members, so that they cannot disagree.
class Packer {
 public:
  template <class T>
  void number(const T& value) {
    append(bytes, value);
  }
  template <class List>
  void flat(const List& list) {
    append(bytes, std::uint64_t{list.size()});
    append_bytes(bytes, std::as_bytes(std::span(list)));
  }
  template <class List, class Each>
  void each(const List& list, const Each& visit) {
    append(bytes, std::uint64_t{list.size()});
    for (const auto& item : list) visit(*this, item);
  }

  std::vector<std::byte> bytes;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : rest_(bytes) {}

  bool failed() const { return failed_; }

  template <class T>
  void number(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> bytes = take(sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof value);
  }
  template <class List>
  void flat(List& list) {
    using Item = typename List::value_type;
    const std::uint64_t count = size(sizeof(Item));
    const std::span<const std::byte> bytes = take(static_cast<std::size_t>(count) * sizeof(Item));
    list.resize(bytes.size() / sizeof(Item));
    if (!bytes.empty()) std::memcpy(list.data(), bytes.data(), bytes.size());
  }
  template <class List, class Each>
  void each(List& list, const Each& visit) {
    list.resize(static_cast<std::size_t>(size(1)));
    for (auto& item : list) visit(*this, item);
  }

 private:
  /// A count that the bytes have room for; 0 where they have not.
  std::uint64_t size(std::size_t item_bytes) {
    std::uint64_t count = 0;
    number(count);
    if (count <= rest_.size() / item_bytes) return count;
    failed_ = true;
    return 0;
  }
  std::span<const std::byte> take(std::size_t count) {
    failed_ |= count > rest_.size();
    if (failed_) return {};
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  std::span<const std::byte> rest_;
  bool failed_ = false;
};

/// `Soup` is const for the way out.
template <class Archive, class Soup>
void visit_members(Archive& archive, Soup& soup) {
  const auto visit_text = [](Archive& a, auto& text) { a.flat(text); };
  archive.flat(soup.file.soup.positions);
  archive.flat(soup.file.soup.indices);
  archive.flat(soup.file.soup.face_material);
  archive.each(soup.file.soup.attributes, [](Archive& a, auto& attribute) {
    a.flat(attribute.name);
    a.number(attribute.type);
    a.number(attribute.component_count);
    a.number(attribute.normalized);
    a.flat(attribute.data);
  });
  archive.each(soup.file.materials, [](Archive& a, auto& material) {
    a.flat(material.name);
    a.number(material.base_color);
    a.number(material.emissive);
    a.number(material.translucent);
  });
  archive.each(soup.file.notes, visit_text);
  archive.each(soup.textures, visit_text);
}

}  // namespace

std::vector<std::byte> pack(const PackedSoup& soup) {
  Packer packer;
  visit_members(packer, soup);
  return std::move(packer.bytes);
}

Result<PackedSoup> unpack(std::span<const std::byte> bytes) {
  PackedSoup soup;
  Unpacker unpacker(bytes);
  visit_members(unpacker, soup);
  if (unpacker.failed()) return fail(ErrorCode::Malformed, "what another process has read is cut off");
  return soup;
}

}  // namespace lodestone::detail
