// Texts are read in pieces, side by side: nothing may show that.

#include "mesh/text_pieces.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <lodestone/core/parallel.h>

#include "base/files_beside.h"
#include "base/number_text.h"
#include "mesh/soup_file.h"
#include "support/catch.h"
#include "support/data.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

using detail::SoupFile;
using Reader = Result<SoupFile> (*)(std::span<const std::byte>, const detail::FileFetcher&, std::size_t);

constexpr std::size_t kWhole = std::size_t{1} << 40;

template <class T>
void add_bytes(std::string& out, const std::vector<T>& values) {
  out += std::to_string(values.size()) + ':';
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Everything that a reader returned, as one string.
std::string all_of(const Result<SoupFile>& file) {
  if (!file) return "error " + std::to_string(static_cast<int>(file.error().code)) + ": " + file.error().message;
  std::string out;
  add_bytes(out, file->soup.positions);
  add_bytes(out, file->soup.indices);
  add_bytes(out, file->soup.face_material);
  for (const Attribute& a : file->soup.attributes) {
    out += a.name + std::to_string(a.component_count);
    add_bytes(out, a.data);
  }
  for (const Material& material : file->materials) out += material.name + '\n';
  for (const std::string& note : file->notes) out += note + '\n';
  return out;
}

std::string read(Reader reader, const std::string& source, std::size_t piece_bytes) {
  return all_of(reader(std::as_bytes(std::span(source)), detail::nothing_beside, piece_bytes));
}

/// Reads a text whole and in pieces of every small size; returns what all of them made of it.
std::string read_everyhow(Reader reader, const std::string& source) {
  std::string whole = read(reader, source, kWhole);
  INFO(source.substr(0, 2000));
  for (const std::size_t piece_bytes : {1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233}) {
    INFO("in pieces of " << piece_bytes << " bytes");
    REQUIRE((read(reader, source, piece_bytes) == whole));
  }
  return whole;
}

/// A grid with all that a statement can hang on: what stands before it, and what stands behind it.
std::string obj_text() {
  std::ostringstream out;
  out << "# a grid\nmtllib none.mtl\nf 1 2 8\n";
  constexpr int kSide = 6;
  for (int row = 0; row < kSide; ++row) {
    if (row % 2 == 1) out << "usemtl stone " << row % 3 << " # not a name\n";
    if (row == 4) out << "usemtl\n";
    for (int column = 0; column < kSide; ++column) {
      out << "v " << column << ' ' << row << ".5e-1 " << column * row << (row == 3 ? " 1 .5 0\n" : "\n");
      out << "vt " << column / 8.0 << " \\\n " << row / 8.0 << "\nvn 0 0 " << (column % 3 == 0 ? "0" : "1") << '\n';
      if (row == 0 || column == 0) continue;
      const int back = kSide + 1;
      out << "f -1/-1/-1 -2/-2/-2 -" << back + 1 << "/-" << back + 1 << "/-" << back + 1 << " -" << back << "//1\n";
      if (column == 3) out << "f 1/2/3 " << 40 - column << "//2 3/99 \\\n 4/1\nl 1 2\n\n";
    }
  }
  out << "v 0 0 9\nv 0 9 9\nv 9 9 9\nv 9 0 9";
  return out.str();
}

std::string ply_text(const std::string& more_vertex = "", const std::string& vertex_end = "") {
  std::ostringstream out;
  constexpr int kSide = 7;
  out << "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement nothing 2\nproperty int a\nelement vertex "
      << kSide * kSide << "\nproperty float x\nproperty float y\nproperty double z\nproperty float nx\n"
      << "property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      << more_vertex << "element face " << (kSide - 1) * (kSide - 1)
      << "\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n"
      << "end_header\n1\n2\n";
  for (int i = 0; i < kSide * kSide; ++i)
    out << i % kSide << ' ' << i / kSide << ".25 " << i * i << "e-3 0 0 " << i % 4 << ' ' << i << " 2 3" << vertex_end
        << (i % 9 == 8 ? "\n \n\n" : "\n");
  for (int i = 0; i < (kSide - 1) * (kSide - 1); ++i) {
    const int first = i / (kSide - 1) * kSide + i % (kSide - 1);
    out << "4 " << first << ' ' << first + 1 << ' ' << first + kSide + 1 << ' ' << first + kSide;
    out << (i % 3 == 0 ? " 0 " : " 8 0 0 1 0 1 1 0 1 ") << i % 2 << '\n';
  }
  return out.str();
}

std::string replaced(std::string source, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = source.find(from, at)) != source.npos; at += to.size())
    source.replace(at, from.size(), to);
  return source;
}

/// Changes, removes, repeats or adds something somewhere.
std::string damaged(std::string source, Random& random) {
  constexpr std::string_view kCharacters = "0123456789-/.e \n\r\\#fvt";
  const std::size_t at = random.below(source.size());
  const char c = kCharacters[random.below(kCharacters.size())];
  switch (random.below(4)) {
    case 0:
      source[at] = c;
      break;
    case 1:
      source.insert(at, 1, c);
      break;
    case 2:
      source.erase(at, 1 + random.below(40));
      break;
    default:
      source.insert(random.below(source.size()), source.substr(at, random.below(60)));
  }
  return source;
}

TEST_CASE("texts are cut behind line ends, and never where a line goes on") {
  const std::string text = "one\ntwo \\\nthree\r\nfour\\\r\nfive\n\n\nsix";
  for (std::size_t piece_bytes = 1; piece_bytes <= text.size() + 1; ++piece_bytes) {
    std::string joined;
    const auto pieces = detail::split_at_lines(text, piece_bytes);
    for (const std::string_view piece : pieces) {
      REQUIRE_FALSE(piece.empty());
      joined += piece;
      CHECK((piece.ends_with('\n') || joined.size() == text.size()));
      CHECK_FALSE(piece.ends_with("\\\n"));
      CHECK_FALSE(piece.ends_with("\\\r\n"));
    }
    CHECK(joined == text);
    if (piece_bytes == 1) CHECK(pieces.size() == 6);
  }
  CHECK(detail::split_at_lines("", 1).empty());
  CHECK(detail::split_at_lines("v 1\rv 2\r", 1).size() == 1);
}

TEST_CASE("rows are lines that are not blank, in the order of the text") {
  detail::TextRows rows("a\n\n b\r\n \t\r\nc\nd", 4);
  const auto text_of = [](const std::vector<detail::Rows>& taken) {
    std::string all;
    std::size_t count = 0;
    for (const detail::Rows& some : taken) all += some.text, count += some.count;
    return std::to_string(count) + all;
  };
  const auto first = rows.take(2);
  REQUIRE(first);
  CHECK(text_of(*first) == "2a\n\n b\r\n");
  const auto none = rows.take(0);
  REQUIRE(none);
  CHECK(none->empty());
  const auto last = rows.take(2);
  REQUIRE(last);
  CHECK(text_of(*last) == "2 \t\r\nc\nd");
  CHECK_FALSE(rows.take(1));
}

TEST_CASE("obj: pieces give what the whole gives, whatever ends its lines") {
  const std::string source = obj_text();
  const std::string whole = read_everyhow(detail::read_obj, source);
  REQUIRE(whole.find("error") == whole.npos);
  CHECK((read_everyhow(detail::read_obj, replaced(source, "\n", "\r\n")) == whole));
  CHECK((read_everyhow(detail::read_obj, replaced(source, "\n", "\r")) == whole));
  CHECK((read_everyhow(detail::read_obj, source + '\n') == whole));
  CHECK(whole.find("stone 1") != whole.npos);
}

TEST_CASE("obj: numbers that count back name what those from the front do") {
  const std::string elements = "v 0 0 0\nv 1 0 0\nvt 0 1\nvt .5 0\nvn 0 0 1\nv 0 1 0\nvt 1 1\nvn 0 1 0\n";
  const std::string from_front = "f 1/1/1 2/2/2 3/3/1\nf 1/2/2 2/3/2 3/1/1\n";
  const std::string from_back = "f -3/-3/-2 -2/-2/-1 -1/-1/-2\nf 1/-2/2 -2/3/-1 3/-3/1\n";
  CHECK((read_everyhow(detail::read_obj, elements + from_back) ==
         read_everyhow(detail::read_obj, elements + from_front)));
}

TEST_CASE("obj: errors name their line, whatever piece it is in") {
  const std::string source = obj_text();
  const auto line_count = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  for (std::size_t at = 0; at != source.npos; at = source.find('\n', at + 1)) {
    if (at > 0 && source[at - 1] == '\\') continue;
    if (kReduced && at % 5 != 0) continue;
    const std::string before = at == 0 ? "" : source.substr(0, at + 1), after = source.substr(before.size());
    const std::string line = "error 2: line " + std::to_string(line_count(before) + 1) + ": ";
    const auto read_with = [&](const std::string& statements) {
      return read_everyhow(detail::read_obj, std::string(before).append(statements).append(after));
    };
    CHECK(read_with("v 1 2 x\n") == line + "'x' is not a number");
    CHECK(read_with("f 1 2 -99\nv oh\n").starts_with(line + "vertex index -99 is out of range: there are "));
    CHECK(read_with("f 1 2 90\nf 1 2 90\n") == line + "vertex index 90 is out of range: the file has 40");
  }
}

TEST_CASE("obj: damaged files give the same in pieces") {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    std::string source = obj_text();
    for (std::uint64_t k = 0; k <= random.below(3); ++k) source = damaged(std::move(source), random);
    read_everyhow(detail::read_obj, source);
  }
}

TEST_CASE("ply: pieces give what the whole gives, whether rows have a line each or not") {
  const std::string source = ply_text();
  const std::string whole = read_everyhow(detail::read_ply, source);
  REQUIRE(whole.find("error") == whole.npos);
  CHECK((read_everyhow(detail::read_ply, replaced(source, "\n", "\r\n")) == whole));
  CHECK((read_everyhow(detail::read_ply, replaced(source, "\n", "\r")) == whole));
  CHECK((read_everyhow(detail::read_ply, source.substr(0, source.size() - 1)) == whole));
  CHECK((read_everyhow(detail::read_ply, replaced(source, " 2 3\n", "\n2 3\n")) == whole));
  CHECK((read_everyhow(detail::read_ply, replaced(source, "4 0 1 8 7", "4 0 1\n8 7")) == whole));
  CHECK((read_everyhow(detail::read_ply, source + "some words\n") == whole));
}

TEST_CASE("ply: elements between those that are read in pieces are passed by, though their rows look like faces") {
  const std::string source = ply_text();
  std::string other = replaced(source, "element face 36\n",
                               "element other 36\nproperty list uchar int a\nproperty list uchar float b\n"
                               "property int c\nelement face 36\n");
  const std::string face = "4 0 1 8 7 0 0\n";
  const std::size_t at = other.find(face);
  REQUIRE(at != other.npos);
  for (int i = 0; i < 36; ++i) other.insert(at, "4 9 9 9 9 0 0\n");
  CHECK((replaced(read_everyhow(detail::read_ply, other), "36 elements 'other' are left out\n", "") ==
         read_everyhow(detail::read_ply, source)));
}

TEST_CASE("ply: errors are told as they are of the whole") {
  CHECK(read_everyhow(detail::read_ply, replaced(ply_text(), " 40 2 3", " 40 2 3 4")) ==
        "error 2: ply: element vertex 40: '4' stands behind the 9 properties that the header says");
  CHECK(read_everyhow(detail::read_ply, replaced(ply_text(), "4 8 9 16 15", "4 8 9 -16 15")) ==
        "error 2: ply: face 7: vertex index -16");
  CHECK(read_everyhow(detail::read_ply, replaced(ply_text(), "4 8 9 16 15", "4 8 9 16 150")) ==
        "error 2: ply: vertex index 150 is out of range: there are 49");
  CHECK(read_everyhow(detail::read_ply, replaced(ply_text(), " 40 2 3", " 40 x 3")) ==
        "error 2: ply: element vertex: the file ends or a number is broken");
  CHECK(read_everyhow(detail::read_ply, replaced(ply_text(), "element face 36", "element face 360000"))
            .starts_with("error 2: ply: element face: count 360000 exceeds the "));
}

TEST_CASE("ply: damaged files give the same in pieces") {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    std::string source = ply_text();
    for (std::uint64_t k = 0; k <= random.below(3); ++k) source = damaged(std::move(source), random);
    read_everyhow(detail::read_ply, source);
  }
}

TEST_CASE("texts are read alike by any number of threads") {
  std::string of_one, of_many;
  const auto read_both = [](std::string& out) {
    out = read(detail::read_obj, obj_text(), 20) + read(detail::read_ply, ply_text(), 20);
  };
  with_threads(1, [&] { read_both(of_one); });
  with_threads(4, [&] { read_both(of_many); });
  CHECK((of_one == of_many));
}

/// Number `i` of texts that look like numbers, more or less.
std::string number_like(Random& random) {
  constexpr std::string_view kCharacters = "0123456789012345678901234567890123456789..eE+-";
  std::string out = random.below(3) == 0 ? "-" : "";
  const std::size_t length = 1 + random.below(22);
  for (std::size_t i = 0; i < length; ++i) out += kCharacters[random.below(random.below(4) == 0 ? 46 : 40)];
  return out;
}

TEST_CASE("floats and doubles are what the standard library reads") {
  Random random(3);
  const auto bits = [](auto value) { return std::string(reinterpret_cast<const char*>(&value), sizeof value); };
  std::vector<std::string> words = {"0",
                                    "-0",
                                    "1.",
                                    ".5",
                                    "-.5e-3",
                                    "1e5",
                                    "1e+5",
                                    "1e-22",
                                    "9007199254740993",
                                    "16777217",
                                    "16777219",
                                    "33554434.0000",
                                    "8388608.5",
                                    "8388609.5",
                                    "1.00000005960464477",
                                    "1e22",
                                    "1e23",
                                    "123456789012345678901234567890",
                                    "0.000000000000000000001",
                                    "-",
                                    ".",
                                    "e5",
                                    "1e",
                                    "1e+",
                                    "1e5x",
                                    "--1",
                                    "inf",
                                    "nan",
                                    "1e999",
                                    "1e-999",
                                    "3.4028236e38"};
  for (int i = 0; i < 200'000; ++i) words.push_back(number_like(random));
  for (int i = 0; i < 100'000; ++i) {
    // In the middle of two floats, exactly.
    const double middle =
        (static_cast<double>(random.below(1 << 24)) + 0.5) * std::ldexp(1.0, static_cast<int>(random.below(20)) - 10);
    std::array<char, 64> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), middle, std::chars_format::fixed);
    words.emplace_back(digits.data(), end.ptr);
  }
  std::size_t wrong = 0;
  for (const std::string& word : words) {
    double expected = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), expected);
    const bool is_number = read.ec == std::errc{} && read.ptr == word.data() + word.size();
    const auto number = detail::parse_double(word);
    wrong += number.has_value() != is_number || (number && bits(*number) != bits(expected));
    float near = 0;
    const auto read_near = std::from_chars(word.data(), word.data() + word.size(), near);
    if (read_near.ec != std::errc{} || read_near.ptr != word.data() + word.size()) continue;
    const auto parsed = detail::parse_float(word);
    wrong += !parsed || bits(*parsed) != bits(near);
  }
  CHECK(wrong == 0);
}

}  // namespace
}  // namespace lodestone::test
