#include "pipeline/build_progress.h"

namespace lodestone::detail {

Progress stage_progress(BuildObserver& observer, BuildStage stage, double begin, double end) {
  Progress progress(
      [&observer, stage, begin, end](double done) { return observer.progress(stage, begin + (end - begin) * done); });
  progress.reach(0);
  return progress;
}

}  // namespace lodestone::detail
