#include <lodestone/io/detail_choice.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {

double pixels_per_unit(const ObjectView& view) {
  if (!(view.distance > 0)) return std::numeric_limits<double>::infinity();
  return view.scale * view.screen_height / (2 * view.distance * std::tan(view.field_of_view / 2));
}

void DetailChoice::look() {
  for (; looked_at_ < mesh_->deviation.size(); ++looked_at_)
    if (better_.empty() || mesh_->deviation[looked_at_] < mesh_->deviation[better_.back()])
      better_.push_back(static_cast<Index>(looked_at_));
}

Index DetailChoice::coarsest(double deviation) {
  look();
  const auto found = std::partition_point(better_.begin(), better_.end(), [&](Index position) {
    return static_cast<double>(mesh_->deviation[position]) > deviation;
  });
  const auto last = static_cast<Index>(mesh_->record_count());
  Index position = found == better_.end() ? last : *found;
  while (!is_whole(*mesh_, position)) ++position;  // a piece that is coming into being
  return position;
}

Index DetailChoice::choose(Index position, double deviation) {
  return std::clamp(position, coarsest(deviation), coarsest(deviation / slack_));
}

}  // namespace lodestone
