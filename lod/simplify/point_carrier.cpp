#include "simplify/point_carrier.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace lodestone::detail {
namespace {

// Enough to tell a face's distance from the surface it stands for; more costs time and gains nothing measurable.
constexpr std::size_t kMaxPointsOfFace = 8;

/// Adds the faces that take over from a sector's fine ones: its coarse faces, or the one beyond where nothing is left.
void add_heirs(const SectorPatch& sector, std::vector<Index>& faces) {
  if (sector.polygon.size() > 2) {
    const auto count = static_cast<std::ptrdiff_t>(sector.triangles.size());
    faces.insert(faces.end(), sector.faces.begin(), sector.faces.begin() + count);
  } else if (sector.lone_outer != kNoIndex) {
    faces.push_back(face_of_corner(sector.lone_outer));
  }
}

}  // namespace

void PointCarrier::carry(const RemovalRecord& record) {
  for (const SectorPatch& sector : record.sectors) {
    take_points(sector);
    if (&sector == &record.sectors.front()) taken_.push_back(record.vertex);
    find_heirs(record, sector);
    choose_nearest(Vec3(state_->mesh.positions[record.vertex]));
    give_points();
  }
}

/// Takes all points off a sector's fine faces.
void PointCarrier::take_points(const SectorPatch& sector) {
  taken_.clear();
  for (const Index face : sector.faces) {
    for (Index p = state_->points.first(face); p != kNoIndex; p = state_->points[p].next) taken_.push_back(p);
    state_->points.clear(face);
  }
}

/// Where nothing is left of a sector and nothing lies beyond, the faces of all sectors take over.
void PointCarrier::find_heirs(const RemovalRecord& record, const SectorPatch& sector) {
  faces_.clear();
  add_heirs(sector, faces_);
  if (!faces_.empty()) return;
  for (const SectorPatch& any : record.sectors) add_heirs(any, faces_);
  std::sort(faces_.begin(), faces_.end());
  faces_.erase(std::unique(faces_.begin(), faces_.end()), faces_.end());
}

/// Finds the heir nearest to each point.
void PointCarrier::choose_nearest(const Vec3& origin) {
  batch_.clear();
  for (const Index p : taken_) batch_.add(Vec3(state_->points[p].position) - origin);
  distance_.resize(batch_.padded_size());
  heir_.assign(taken_.size(), {});
  for (const Index face : faces_) {
    const auto corner = [&](Index i) {
      return Vec3(state_->mesh.positions[state_->connectivity.vertex(3 * face + i)]) - origin;
    };
    squared_distances(batch_, {corner(0), corner(1), corner(2)}, distance_.data());
    for (std::size_t i = 0; i < taken_.size(); ++i)
      if (distance_[i] < heir_[i].squared_distance) heir_[i] = {face, distance_[i]};
  }
}

void PointCarrier::give_points() {
  CarriedPoints& points = state_->points;
  for (const Index face : faces_) {
    // What the heir holds already stays in the count: the face beyond an ear keeps its own points.
    members_.clear();
    for (Index p = points.first(face); p != kNoIndex; p = points[p].next) members_.push_back(p);
    points.clear(face);
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      if (heir_[i].face != face) continue;
      members_.push_back(taken_[i]);
      points[taken_[i]].squared_distance = heir_[i].squared_distance;
    }
    thin();
    for (const Index p : members_) points.add(face, p);
  }
}

/// Keeps every n-th point of a crowded face, with the weight of all.
void PointCarrier::thin() {
  if (members_.size() <= kMaxPointsOfFace) return;
  CarriedPoints& points = state_->points;
  const auto weight_of = [&](float sum, Index p) { return sum + points[p].weight; };
  const float before = std::accumulate(members_.begin(), members_.end(), 0.0F, weight_of);
  for (std::size_t i = 0; i < kMaxPointsOfFace; ++i) members_[i] = members_[i * members_.size() / kMaxPointsOfFace];
  members_.resize(kMaxPointsOfFace);
  const float after = std::accumulate(members_.begin(), members_.end(), 0.0F, weight_of);
  for (const Index p : members_) points[p].weight *= before / after;
}

}  // namespace lodestone::detail
