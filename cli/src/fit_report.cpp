#include "fit_report.h"

#include <algorithm>
#include <cstdio>

#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"

namespace mien {
namespace {

struct Line {
  std::string name;
  double mean = 0, most = 0;
};

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

std::vector<Line> lines_of(const FitOutcome& outcome) {
  const auto line = [&](std::string name, const std::vector<double>& r) {
    return Line{std::move(name), outcome.mm_per_residual * mean_of(r),
                r.empty() ? 0 : outcome.mm_per_residual * *std::max_element(r.begin(), r.end())};
  };
  std::vector<Line> lines = {line("all", outcome.residual)};
  for (const auto& [name, residual] : outcome.region_residual) lines.push_back(line(name, residual));
  return lines;
}

}  // namespace

void print_fit(const std::filesystem::path& input, const std::filesystem::path& output,
               const FitOutcome& outcome, bool json) {
  const std::string frames = std::to_string(outcome.motion.num_frames());
  const std::vector<Line> lines = lines_of(outcome);
  if (json) {
    std::string regions;
    for (const Line& line : lines)
      regions += (regions.empty() ? "" : ",") + json_string(line.name) +
                 ":{\"mean_mm\":" + fixed(line.mean, 6) + ",\"max_mm\":" + fixed(line.most, 6) + "}";
    std::printf(
        "{\"input\":%s,\"output\":%s,\"frames\":%s,\"fps\":%s,\"mm_per_unit\":%s,\"residual\":{%s}}\n",
        json_string(input.string()).c_str(), json_string(output.string()).c_str(), frames.c_str(),
        fixed(outcome.motion.fps, 3).c_str(), fixed(outcome.mm_per_unit, 6).c_str(), regions.c_str());
    return;
  }
  std::printf("%s: %s frames\n  %-14s %10s %10s\n", input.string().c_str(), frames.c_str(), "residual, mm",
              "mean", "worst");
  for (const Line& line : lines)
    std::printf("  %-14s %10s %10s\n", line.name.c_str(), fixed(line.mean, 4).c_str(),
                fixed(line.most, 4).c_str());
}

std::string residual_header(const FitOutcome& outcome) {
  std::string text = "sequence,frame,all_mm";
  for (const auto& [region, residual] : outcome.region_residual) text += "," + region + "_mm";
  return text + "\n";
}

std::string residual_rows(const std::string& sequence, const FitOutcome& outcome) {
  const double mm = outcome.mm_per_residual;
  std::string text;
  for (std::size_t n = 0; n < outcome.residual.size(); ++n) {
    text += sequence + "," + std::to_string(n) + "," + fixed(mm * outcome.residual[n], 6);
    for (const auto& [region, residual] : outcome.region_residual) text += "," + fixed(mm * residual[n], 6);
    text += "\n";
  }
  return text;
}

}  // namespace mien
