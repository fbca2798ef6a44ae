// mien_fuzz: damages files at random and gives them to a reader. docs/testing.md.
#include <sanitizer/common_interface_defs.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <set>

#include "mien/base/file.h"
#include "mutate.h"
#include "target.h"

// The sanitizers' settings: an allocation beyond what any of our limits allows is a finding.
extern "C" const char* __asan_default_options() {
  return "max_allocation_size_mb=1024:allocator_may_return_null=0:handle_abort=1:detect_leaks=1";
}

namespace mien::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kHangSeconds = 20;
constexpr std::size_t kMaxSeedBytes = 1 << 18, kMaxPool = 4000;

const Bytes* current_input = nullptr;
char crash_path[256];

void save_current_input() {
  if (current_input == nullptr) return;
  if (std::FILE* file = std::fopen(crash_path, "wb")) {
    std::fwrite(current_input->data(), 1, current_input->size(), file);
    std::fclose(file);
    std::fprintf(stderr, "the input is saved as %s\n", crash_path);
  }
}

extern "C" void on_alarm(int) {
  std::fputs("error: the reader hangs\n", stderr);
  save_current_input();
  ::_exit(1);
}

// The outcome without what differs from file to file: numbers, what is quoted, what a colon announces.
std::string kind_of(const Outcome& outcome) {
  std::string how = outcome.how;
  const auto first = how.find('\''), last = how.rfind('\'');
  if (first != last) how.erase(first, last - first);
  std::string kind = outcome.is_read ? "read " : "refused ";
  bool is_list = false;
  for (const char c : how.substr(0, 300)) {
    const bool is_digit = c >= '0' && c <= '9';
    if (c == ';' || c == '|') is_list = false;
    if (!is_list && !(is_digit && kind.back() == '#')) kind += is_digit ? '#' : c;
    if (c == ':' && outcome.is_read) is_list = true;
  }
  return kind;
}

class Fuzzer {
 public:
  Fuzzer(const Target& target, std::uint64_t seed) : target_(target), rng_(seed) {}

  void give(Bytes input) {
    current_input = &input;
    ::alarm(kHangSeconds);
    const Outcome outcome = target_.read(input);
    ::alarm(0);
    current_input = nullptr;
    ++runs_;
    read_ += outcome.is_read;
    if (input.size() <= kMaxSeedBytes && pool_.size() < kMaxPool && kinds_.insert(kind_of(outcome)).second)
      pool_.push_back(std::move(input));
  }
  void step() {
    const auto pick = [&] { return static_cast<std::size_t>(rng_.below(pool_.size())); };
    Bytes input = pool_[pick()];
    for (std::uint64_t n = 1 + rng_.below(5); n > 0; --n) mutate(input, pool_[pick()], target_.words, rng_);
    input.shrink_to_fit();  // a read beyond the end is a read beyond the allocation
    give(std::move(input));
  }
  void print() const {
    std::printf("%-15.*s %9lld inputs, %lld accepted, %zu kinds of outcome\n",
                static_cast<int>(target_.name.size()), target_.name.data(), static_cast<long long>(runs_),
                static_cast<long long>(read_), kinds_.size());
  }
  void print_kinds() const {
    for (const auto& kind : kinds_) std::printf("  %s\n", kind.c_str());
  }

 private:
  Target target_;
  Rng rng_;
  std::vector<Bytes> pool_;
  std::set<std::string> kinds_;
  std::int64_t runs_ = 0, read_ = 0;
};

std::vector<fs::path> files_in(const std::vector<std::string>& names) {
  std::vector<fs::path> files;
  for (const auto& name : names) {
    if (!fs::is_directory(name))
      files.emplace_back(name);
    else
      for (const auto& entry : fs::recursive_directory_iterator(name))
        if (entry.is_regular_file() && entry.file_size() <= kMaxSeedBytes) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace
}  // namespace mien::fuzz

int main(int argc, char** argv) {
  using namespace mien;
  using namespace mien::fuzz;
  const std::vector<Target> targets = {wav_target(),
                                       safetensors_target(),
                                       gltf_target(),
                                       motion_csv_target(),
                                       motion_json_target(),
                                       npy_target(),
                                       flame_csv_target(),
                                       flame_target(),
                                       direction_csv_target(),
                                       direction_json_target(),
                                       zip_target(),
                                       pickle_target(),
                                       torch_state_target(),
                                       torch_target(),
                                       obj_target(),
                                       ply_target(),
                                       vl_target(),
                                       mask_csv_target(),
                                       keys_csv_target()};
  CLI::App app("Gives damaged files to a reader until it breaks.");
  std::string name;
  std::vector<std::string> names, seeds;
  for (const auto& target : targets) names.emplace_back(target.name);
  std::int64_t runs = 10000;
  double seconds = 0;
  std::uint64_t seed = 1;
  bool kinds = false;
  app.add_option("READER", name)->required()->check(CLI::IsMember(names));
  app.add_option("FILES", seeds, "Files or folders to begin with, beside the built-in ones");
  app.add_option("--runs", runs, "Damaged files to try; 0: only the files themselves")->capture_default_str();
  app.add_option("--seconds", seconds, "Try for so long instead");
  app.add_option("--seed", seed)->capture_default_str();
  app.add_flag("--kinds", kinds, "Print the kinds of outcome that were seen");
  CLI11_PARSE(app, argc, argv);

  std::snprintf(crash_path, sizeof crash_path, "crash-%s", name.c_str());
  __sanitizer_set_death_callback(&save_current_input);
  std::signal(SIGALRM, &on_alarm);
  const Target& target =
      *std::find_if(targets.begin(), targets.end(), [&](const auto& t) { return t.name == name; });
  Fuzzer fuzzer(target, seed);
  for (auto& bytes : target.seeds()) fuzzer.give(std::move(bytes));
  for (const auto& file : files_in(seeds)) {
    auto bytes = read_file(file);
    if (!bytes) {
      std::fprintf(stderr, "error: %s\n", bytes.error().message().c_str());
      return 3;
    }
    fuzzer.give(std::move(*bytes));
  }
  const auto start = std::chrono::steady_clock::now();
  const auto is_over = [&](std::int64_t i) {
    if (seconds <= 0) return i >= runs;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >= seconds;
  };
  for (std::int64_t i = 0; !is_over(i); ++i) fuzzer.step();
  fuzzer.print();
  if (kinds) fuzzer.print_kinds();
  return 0;
}
