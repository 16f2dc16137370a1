// How long whole jobs take, with how much memory, and how good their result is: lodestone beside other simplifiers.
//
//   speed [--faces 10k,100k,1M] [--to 10%] [--threads 1,2] [--runs 3] [--only stream,meshopt] [--effort 5] [FILE …]
//
// Each simplifies the same mesh to the same count. Each run is a process of its own, so that none finds the memory or
// the threads of another; simplifiers take turns, so that what else the machine does meets all of them.

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include <lodestone/core/effort.h>
#include <lodestone/core/parallel.h>
#include <lodestone/io/read_mesh.h>

#include "child.h"
#include "displaced_torus.h"
#include "peak_memory.h"
#include "peers/lodestone_stream.h"
#include "peers/referee.h"
#include "peers/simplifier.h"

namespace lodestone::bench {
namespace {

struct Options {
  std::vector<std::size_t> faces = {10'000, 100'000, 1'000'000};
  std::vector<std::string> files;
  std::string to = "10%";
  std::vector<std::size_t> threads;
  int runs = 3;
  std::vector<std::string> only = {"stream", "bounds", "levels", "meshopt", "openmesh", "lt"};
  int effort = kDefaultEffort;
  std::size_t samples = 500'000;  // each way
};

constexpr const char* kYardstick = "meshopt";

/// A simplifier at a number of threads, and what became of it on one mesh.
struct Job {
  const Simplifier* simplifier;
  std::size_t threads;
  std::vector<Seconds> seconds;
  std::vector<double> peak_bytes;  ///< none where the system does not tell
  Judgement judgement;
  bool failed = false;
};

// What a process sends to the one that started it.

template <class T>
void put(const std::vector<T>& values, std::string& bytes) {
  const std::size_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof(count));
  bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

template <class T>
std::vector<T> take(const char*& bytes) {
  std::size_t count = 0;
  std::memcpy(&count, bytes, sizeof(count));
  std::vector<T> values(count);
  std::memcpy(values.data(), bytes + sizeof(count), count * sizeof(T));
  bytes += sizeof(count) + count * sizeof(T);
  return values;
}

/// Makes a mesh elsewhere: this process is to start no threads. Positions alone; nothing where there is no such mesh.
std::optional<Mesh> make_mesh(const std::function<TriangleSoup()>& make) {
  const std::optional<std::string> bytes = in_child([&] {
    const Mesh mesh = positions_of(make());
    std::string sent;
    put(mesh.positions, sent);
    put(mesh.wedge_vertex, sent);
    put(mesh.corner_wedge, sent);
    return sent;
  });
  if (!bytes) return std::nullopt;
  const char* at = bytes->data();
  Mesh mesh;
  mesh.positions = take<Vec3f>(at);
  mesh.wedge_vertex = take<Index>(at);
  mesh.corner_wedge = take<Index>(at);
  if (mesh.corner_wedge.empty()) return std::nullopt;
  return mesh;
}

struct Outcome {
  Seconds seconds;
  double peak_bytes = 0;  ///< 0: unknown
  Judgement judgement;    ///< of no faces where it was not judged
};
static_assert(std::is_trivially_copyable_v<Outcome>);

Outcome run_job(const Job& job, const Mesh& mesh, std::size_t faces, std::optional<std::size_t> samples) {
  const PeakMemory memory;
  std::vector<Level> levels;
  with_threads(job.threads, [&] { levels = job.simplifier->run(mesh, std::span(&faces, 1)); });
  Outcome outcome;
  outcome.peak_bytes = static_cast<double>(memory.bytes().value_or(0));
  outcome.seconds = levels.front().seconds;
  if (samples) outcome.judgement = Referee(surface_of(mesh), *samples).judge(levels.front().surface);
  return outcome;
}

void add_run(Job& job, const Mesh& mesh, std::size_t faces, std::optional<std::size_t> samples) {
  const std::optional<std::string> bytes = in_child([&] {
    const Outcome outcome = run_job(job, mesh, faces, samples);
    return std::string(reinterpret_cast<const char*>(&outcome), sizeof(outcome));
  });
  if (!bytes || bytes->size() != sizeof(Outcome)) {
    job.failed = true;
    return;
  }
  Outcome outcome;
  std::memcpy(&outcome, bytes->data(), sizeof(outcome));
  job.seconds.push_back(outcome.seconds);
  if (outcome.peak_bytes > 0) job.peak_bytes.push_back(outcome.peak_bytes);
  if (samples) job.judgement = outcome.judgement;
}

/// lodestone's at every number of threads; the others have one.
std::vector<Job> jobs_of(const std::vector<Simplifier>& simplifiers, const std::vector<std::size_t>& threads) {
  std::vector<Job> jobs;
  for (const Simplifier& simplifier : simplifiers) {
    for (const std::size_t count : simplifier.has_effort ? threads : std::vector<std::size_t>{1})
      jobs.push_back({&simplifier, count, {}, {}, {}, false});
  }
  return jobs;
}

void run_all(std::vector<Job>& jobs, const std::string& name, const Mesh& mesh, std::size_t faces,
             const Options& options) {
  for (int run = 0; run < options.runs; ++run) {
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      Job& job = jobs[i];
      if (job.failed) continue;
      std::fprintf(stderr, "%s, run %d: %s, threads: %zu\n", name.c_str(), run + 1, job.simplifier->name.c_str(),
                   job.threads);
      // The result is the same in every run, and for any number of threads.
      const bool is_first = run == 0 && (i == 0 || jobs[i - 1].simplifier != job.simplifier);
      add_run(job, mesh, faces, is_first && options.samples > 0 ? std::optional(options.samples) : std::nullopt);
      if (!is_first && i > 0 && jobs[i - 1].simplifier == job.simplifier) job.judgement = jobs[i - 1].judgement;
    }
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

double median_of(const std::vector<Seconds>& seconds, double Seconds::*part) {
  std::vector<double> values;
  for (const Seconds& s : seconds) values.push_back(s.*part);
  return median(std::move(values));
}

/// Returns the job's time as a multiple of the yardstick's, each run's beside it.
double multiple_of(const Job& job, const std::vector<Job>& jobs) {
  std::vector<double> multiples;
  for (const Job& other : jobs) {
    if (other.simplifier->key != kYardstick) continue;
    for (std::size_t run = 0; run < std::min(job.seconds.size(), other.seconds.size()); ++run)
      multiples.push_back(job.seconds[run].cpu / other.seconds[run].cpu);
  }
  return median(std::move(multiples));
}

std::string text_of(const char* pattern, double value) {
  if (std::isnan(value)) return "–";
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), pattern, value);
  return buffer.data();
}

void print_rows(const std::vector<Job>& jobs, const std::string& name, double faces) {
  for (const Job& job : jobs) {
    std::printf("| %s | %s | %zu |", name.c_str(), job.simplifier->name.c_str(), job.threads);
    if (job.failed) {
      std::puts(" did not end well | | | | | | | |");
      continue;
    }
    const double wall = median_of(job.seconds, &Seconds::wall);
    const bool is_judged = job.judgement.faces > 0;
    const std::array<std::string, 8> cells = {text_of("%.3f s", wall),
                                              text_of("%.3f s", median_of(job.seconds, &Seconds::cpu)),
                                              text_of("%.2f", multiple_of(job, jobs)),
                                              text_of("%.3f M", faces / wall * 1e-6),
                                              text_of("%.0f", median(job.peak_bytes) / faces),
                                              is_judged ? std::to_string(job.judgement.faces) : "–",
                                              is_judged ? text_of("%.3g", job.judgement.mean) : "–",
                                              is_judged ? text_of("%.3g", job.judgement.rms) : "–"};
    for (const std::string& cell : cells) std::printf(" %s |", cell.c_str());
    std::puts("");
  }
  std::fflush(stdout);
}

void print_head(const Options& options) {
  std::printf(
      "Medians of %d runs that took turns. CPU: all threads together, and as a multiple of meshoptimizer's in the same "
      "turn. Triangles: of the whole mesh, each second by the clock. Peak: bytes for each of the mesh's faces, beyond "
      "the mesh itself. Mean and rms: distances of both directions, averaged, in %% of the diagonal, by the referee of "
      "the table of quality. lodestone goes to the base mesh and keeps every record, at effort %d.\n\n",
      options.runs, options.effort);
  for (const auto& name : missing_simplifiers()) std::printf("Not found: %s.\n\n", name.c_str());
  std::puts(
      "| mesh | | threads | time | CPU | of meshoptimizer's | triangles/s | peak | faces | mean | rms |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|");
}

/// The stream's simplification with the work that a build asks of it: bounds for every record.
Simplifier stream_with_bounds(int effort) {
  const auto run = [effort](const Mesh& mesh, std::span<const std::size_t> face_counts) {
    SimplifyOptions options;
    options.effort = effort;
    return lodestone_stream(mesh, face_counts, options);
  };
  return {"bounds", "lodestone, stream with bounds", true, run, true};
}

/// Returns those asked for, in that order; nothing where there is none of some name.
std::vector<Simplifier> chosen_simplifiers(const Options& options) {
  std::vector<Simplifier> all = simplifiers(options.effort);
  all.push_back(stream_with_bounds(options.effort));
  std::vector<Simplifier> chosen;
  for (const std::string& key : options.only) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Simplifier& s) { return s.key == key; });
    if (found == all.end()) {
      std::fprintf(stderr, "speed: no simplifier '%s'\n", key.c_str());
      continue;
    }
    chosen.push_back(*found);
  }
  return chosen;
}

/// "855" or "10%" of a mesh's faces; nothing where the text is neither.
std::optional<std::size_t> target_of(const std::string& text, std::size_t faces) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool is_share = std::strcmp(end, "%") == 0;
  if (end == text.c_str() || (!is_share && *end != '\0') || !(value > 0)) return std::nullopt;
  const double count = is_share ? std::round(value / 100 * static_cast<double>(faces)) : value;
  return static_cast<std::size_t>(std::clamp(count, 1.0, static_cast<double>(faces)));
}

/// Adds a mesh's rows; returns whether there is one.
bool measure(const std::string& name, const std::function<TriangleSoup()>& make,
             const std::vector<Simplifier>& simplifiers, const Options& options) {
  const std::optional<Mesh> mesh = make_mesh(make);
  if (!mesh) {
    std::fprintf(stderr, "%s: no mesh\n", name.c_str());
    return false;
  }
  const std::size_t target = target_of(options.to, mesh->face_count()).value();
  const std::string title = name + ", " + std::to_string(mesh->face_count()) + " to " + std::to_string(target);
  std::vector<Job> jobs = jobs_of(simplifiers, options.threads);
  run_all(jobs, title, *mesh, target, options);
  print_rows(jobs, title, static_cast<double>(mesh->face_count()));
  return true;
}

TriangleSoup read_soup(const std::string& path) {
  const Result<MeshFile> file = read_mesh(path);
  if (file) return to_soup(file->mesh);
  std::fprintf(stderr, "%s: %s\n", path.c_str(), file.error().message.c_str());
  return {};
}

int run(const Options& options) {
  const std::vector<Simplifier> chosen = chosen_simplifiers(options);
  if (chosen.size() < options.only.size()) return 1;
  print_head(options);
  std::size_t missing = 0;
  const auto measure_one = [&](const std::string& name, const std::function<TriangleSoup()>& make) {
    if (!measure(name, make, chosen, options)) ++missing;
  };
  for (const std::string& path : options.files)
    measure_one(std::filesystem::path(path).stem().string(), [&] { return read_soup(path); });
  for (const std::size_t faces : options.files.empty() ? options.faces : std::vector<std::size_t>{})
    measure_one("torus", [&] { return displaced_torus(faces); });
  return missing == 0 ? 0 : 1;
}

}  // namespace
}  // namespace lodestone::bench

int main(int argc, char** argv) {
  lodestone::bench::Options options;
  options.threads = {1};
  if (const std::size_t cores = std::thread::hardware_concurrency(); cores > 1) options.threads.push_back(cores);
  CLI::App app("Measures lodestone and other simplifiers at whole jobs and prints Markdown.");
  app.add_option("FILE", options.files, "meshes; without any, displaced tori are made");
  app.add_option("--faces", options.faces, "about how many faces they have, e.g. 10k,1M")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(CLI::AsNumberWithUnit(std::map<std::string, std::size_t>{{"k", 1'000}, {"M", 1'000'000}},
                                        CLI::AsNumberWithUnit::CASE_SENSITIVE));
  app.add_option("--to", options.to, "faces to simplify to, or a share in %")->check([](const std::string& text) {
    return lodestone::bench::target_of(text, 1) ? std::string() : "'" + text + "' is no count and no share";
  });
  app.add_option("--threads", options.threads, "numbers of threads that lodestone is measured at")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::PositiveNumber);
  app.add_option("--runs", options.runs, "of each")->check(CLI::PositiveNumber);
  app.add_option("--only", options.only,
                 "simplifiers: stream, bounds, levels, meshopt, openmesh, lt, lt-end, gh, vtk, vtk-pro")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--effort", options.effort, "lodestone's, 1 to 9")
      ->check(CLI::Range(lodestone::kLeastEffort, lodestone::kMostEffort));
  app.add_option("--samples", options.samples, "that the referee takes of a surface, each way, at most; 0: no referee");
  CLI11_PARSE(app, argc, argv);
  return lodestone::bench::run(options);
}
