// A record's sectors follow from its star: they end where groups or wedges differ on a spoke's sides. What a sector's
// corners enclose of the coarse faces tells its shape: one fewer than it has faces where it is open, as many where the
// vertex moved away from it, and then a corner that is not its own; two fewer where the vertex moved to a corner
// inside, at which it has to be cut.

#include "codec/star.h"

#include <algorithm>

namespace lodestone::detail {
namespace {

template <class T>
std::span<const T> part_of(const std::vector<T>& all, std::size_t begin, std::size_t end) {
  return std::span(all).subspan(begin, end - begin);
}

/// A stretch of a star's faces; its corners are the places begin … begin + count, modulo the ring.
struct Run {
  std::size_t begin = 0;
  std::size_t count = 0;
};

class Splitter {
 public:
  Splitter(const Star& star, SectorList& sectors) : star_(star), sectors_(sectors), ring_size_(star.ring_size()) {}

  bool split() {
    const std::size_t count = star_.faces.size();
    if (count == 0 || ring_size_ > kMostPlaces) return false;
    const auto spoke_at = [&](std::size_t i) -> const Star::Spoke& { return star_.faces[i]; };
    const auto place_of = [](const Star::Coarse& triangle, std::size_t k) { return triangle.places[k]; };
    if (star_.closed && !has_cut(count, spoke_at))
      return add_closed(count, spoke_at, std::span<const Star::Coarse>(star_.coarse), place_of, sectors_);
    std::size_t first = 0;
    if (star_.closed)
      while (!is_cut(first)) ++first;
    is_used_.assign(star_.coarse.size(), false);
    // A face alone stands on an edge of what others enclose, or has moved with a coarse face that is left over.
    for (const bool alone : {false, true})
      for (std::size_t begin = 0; begin < count;) {
        std::size_t end = begin + 1;
        while (end < count && !is_cut((first + end) % count)) ++end;
        if ((end == begin + 1) == alone && !add_run({first + begin, end - begin})) return false;
        begin = end;
      }
    return used_ == star_.coarse.size();
  }

 private:
  const Star::Spoke& face(std::size_t i) const { return star_.faces[i % star_.faces.size()]; }

  /// Whether something differs at the spoke between two faces.
  bool is_cut(std::size_t i) const {
    const Star::Spoke &before = face(i + star_.faces.size() - 1), &after = face(i);
    return before.centre != after.centre || before.group != after.group || before.to != after.from;
  }

  /// A ring corner's number in a run's polygon; more than `count` where it has none. A ring that begins and ends at one
  /// corner has it twice.
  std::size_t number(const Run& run, std::size_t place) const {
    return (place + 2 * ring_size_ - run.begin % ring_size_) % ring_size_;
  }
  bool lies_in(const Run& run, const Star::Coarse& triangle) const {
    return std::all_of(triangle.places.begin(), triangle.places.end(),
                       [&](Index place) { return number(run, place) <= run.count; });
  }
  std::size_t coarse_in(const Run& run) const {
    return static_cast<std::size_t>(std::count_if(star_.coarse.begin(), star_.coarse.end(),
                                                  [&](const auto& t) { return lies_in(run, t) && fits(run, t); }));
  }

  bool add_run(const Run& run) {
    if (run.count < ring_size_) {
      const bool is_alone = run.count == 1;
      if (!is_alone && coarse_in(run) + 1 == run.count) return add_open(run);
      if (coarse_moved(run) == run.count) return add_moved(run);
      if (is_alone) return add_open(run);
    }
    for (std::size_t cut = 1; cut < run.count; ++cut) {
      const Run left = {run.begin, cut}, right = {run.begin + cut, run.count - cut};
      if (coarse_in(left) + 1 == left.count && coarse_in(right) + 1 == right.count)
        return add_open(left) && add_open(right);
    }
    return false;
  }

  /// Whether a coarse face has an edge of the run, its third corner elsewhere, and nobody has it.
  bool has_moved(const Run& run, std::size_t i) const {
    const Star::Coarse& t = star_.coarse[i];
    std::size_t outside = 0, sum = 0, least = run.count;
    for (const Index place : t.places) {
      const std::size_t at = number(run, place);
      if (at > run.count) {
        ++outside;
        continue;
      }
      sum += at;
      least = std::min(least, at);
    }
    return outside == 1 && sum == 2 * least + 1 && !is_used_[i] && fits(run, t);
  }
  std::size_t coarse_moved(const Run& run) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < star_.coarse.size(); ++i) count += has_moved(run, i) ? 1 : 0;
    return count;
  }

  void add_corners(const Run& run) {
    for (std::size_t i = 0; i < run.count; ++i) {
      sectors_.polygons.push_back(face(run.begin + i).from);
      sectors_.fine.push_back(face(run.begin + i).face);
    }
  }

  /// Adds a coarse face whose corners have these numbers in the polygon at the end.
  bool add_coarse(const Run& run, std::size_t i, const std::array<std::size_t, 3>& numbers) {
    const Star::Coarse& triangle = star_.coarse[i];
    if (is_used_[i]) return false;
    is_used_[i] = true;
    const std::size_t begin = sectors_.sectors.empty() ? 0 : sectors_.sectors.back().polygon_end;
    if (triangle.group != face(run.begin).group) return false;
    for (std::size_t k = 0; k < 3; ++k)
      if (begin + numbers[k] >= sectors_.polygons.size() || sectors_.polygons[begin + numbers[k]] != triangle.wedges[k])
        return false;
    ++used_;
    return sectors_.add_coarse(triangle.face, numbers);
  }

  bool end(const Run& run, SectorShape shape) {
    sectors_.end_sector(shape, face(run.begin).group, face(run.begin).centre);
    return true;
  }

  bool add_open(const Run& run) {
    add_corners(run);
    sectors_.polygons.push_back(face(run.begin + run.count - 1).to);
    for (std::size_t i = 0; i < star_.coarse.size(); ++i) {
      const Star::Coarse& t = star_.coarse[i];
      if (lies_in(run, t) &&
          !add_coarse(run, i, {number(run, t.places[0]), number(run, t.places[1]), number(run, t.places[2])}))
        return false;
    }
    return end(run, SectorShape::Open);
  }

  /// The coarse faces each have an edge of the run, and all the corner that is not its own.
  bool add_moved(const Run& run) {
    add_corners(run);
    sectors_.polygons.push_back(face(run.begin + run.count - 1).to);
    const std::size_t last = run.count + 1;
    Index target = kNoIndex;
    std::size_t added = 0;
    for (std::size_t i = 0; i < star_.coarse.size(); ++i) {
      const Star::Coarse& t = star_.coarse[i];
      std::array<std::size_t, 3> numbers{};
      std::size_t beyond = 0;
      if (!has_moved(run, i)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        numbers[k] = std::min(number(run, t.places[k]), last);
        if (numbers[k] == last) beyond = k;
      }
      if (target == kNoIndex) {
        target = t.places[beyond];
        sectors_.polygons.push_back(t.wedges[beyond]);
      }
      if (target != t.places[beyond] || !add_coarse(run, i, numbers)) return false;
      ++added;
    }
    return added == run.count && end(run, SectorShape::Moved);
  }

  /// Whether a coarse face has the wedges of the run's polygon, where it has corners of it.
  bool fits(const Run& run, const Star::Coarse& t) const {
    if (t.group != face(run.begin).group) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = number(run, t.places[k]);
      if (at > run.count) continue;
      const Index wedge = at < run.count ? face(run.begin + at).from : face(run.begin + at - 1).to;
      if (t.wedges[k] != wedge) return false;
    }
    return true;
  }

  const Star& star_;
  SectorList& sectors_;
  std::size_t ring_size_;
  std::size_t used_ = 0;
  std::vector<bool> is_used_;  // by coarse face
};

}  // namespace

void SectorList::clear() {
  sectors.clear();
  polygons.clear();
  coarse.clear();
  triangles.clear();
  fine.clear();
}

std::span<const Index> SectorList::polygon(std::size_t s) const {
  return part_of(polygons, s == 0 ? 0 : sectors[s - 1].polygon_end, sectors[s].polygon_end);
}
std::span<const Index> SectorList::coarse_of(std::size_t s) const {
  return part_of(coarse, s == 0 ? 0 : sectors[s - 1].coarse_end, sectors[s].coarse_end);
}
std::span<const std::array<std::uint8_t, 3>> SectorList::triangles_of(std::size_t s) const {
  return part_of(triangles, s == 0 ? 0 : sectors[s - 1].coarse_end, sectors[s].coarse_end);
}
std::span<const Index> SectorList::fine_of(std::size_t s) const {
  return part_of(fine, s == 0 ? 0 : sectors[s - 1].fine_end, sectors[s].fine_end);
}

bool SectorList::add_coarse(Index face, std::array<std::size_t, 3> places) {
  if (places[0] > places[1]) std::swap(places[0], places[1]);
  if (places[1] > places[2]) std::swap(places[1], places[2]);
  if (places[0] > places[1]) std::swap(places[0], places[1]);
  if (places[0] == places[1] || places[1] == places[2] || places[2] >= kMostPlaces) return false;
  const auto narrow = [&](std::size_t k) { return static_cast<std::uint8_t>(places[k]); };
  coarse.push_back(face);
  triangles.push_back({narrow(0), narrow(1), narrow(2)});
  return true;
}

void SectorList::end_sector(SectorShape shape, Index group, Index wedge) {
  sectors.push_back({shape, group, wedge, static_cast<Index>(polygons.size()), static_cast<Index>(coarse.size()),
                     static_cast<Index>(fine.size())});
}

bool split_star(const Star& star, SectorList& sectors) { return Splitter(star, sectors).split(); }

}  // namespace lodestone::detail
