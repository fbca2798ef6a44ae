// What a user waits for: `mien animate` with a SAiD model of the published size, from the start of the
// process to the written file, for 4 s of sound. Weights are random; speed does not depend on them. Needs the
// program beside mien_bench.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "import/parameter_list.h"
#include "mien/base/hash.h"
#include "mien/base/random.h"
#include "mien/models/model_file.h"
#include "mien/models/said/network.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/runtime_operations.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr int kSeconds = 4, kSampleRateHz = 16000;

/// The program that was built beside this one.
fs::path program() { return fs::read_symlink("/proc/self/exe").parent_path() / "mien"; }

void need(bool done, const std::string& what) {
  if (!done) throw std::runtime_error(what);
}

/// Random weights of a size that keeps values near one.
void write_said(const fs::path& path) {
  ModelFile m;
  m.architecture = Architecture::said;
  m.name = "random";
  m.encoder = EncoderConfig{};
  m.output = {.space = "arkit", .channels = 32, .fps = 60, .topology = ""};
  m.diffusion = ModelDiffusion{"cosine", 1000};
  SpeechEncoder<Tensor> encoder(*m.encoder);
  said::Network<Tensor> network(said::Sizes{});
  ListParameters list;
  list.scope("audio_encoder", encoder);
  network.visit(list);
  std::vector<StoredTensor> tensors;
  for (const auto& e : list.entries) tensors.push_back({e.name, Dtype::f32, e.shape});
  auto writer = SafetensorsWriter::create(path, tensors, to_metadata(m));
  need(writer.has_value(), "cannot write " + path.string());
  for (const StoredTensor& t : tensors) {
    std::vector<float> values(static_cast<std::size_t>(t.count()));
    NoiseField(hash64(t.name), 0).normal(0, 0, values);
    const bool is_vector = t.shape.size() == 1;
    const double inputs = is_vector ? 10 : static_cast<double>(t.count()) / static_cast<double>(t.shape[0]);
    const bool is_scale = is_vector && t.name.find("norm") != std::string::npos && t.name.ends_with("weight");
    for (float& v : values) v = (is_scale ? 1.0f : 0.0f) + static_cast<float>(1 / std::sqrt(inputs)) * v;
    need(writer->write_float(t.name, values).has_value(), "cannot write " + t.name);
  }
  need(writer->finish().has_value(), "cannot finish " + path.string());
}

/// A tone that comes and goes, 16-bit.
void write_sound(const fs::path& path) {
  constexpr std::uint32_t kBytes = 2 * kSeconds * kSampleRateHz;
  std::ofstream out(path, std::ios::binary);
  const auto put = [&](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) out.put(static_cast<char>(value >> (8 * i) & 0xff));
  };
  out << "RIFF", put(36 + kBytes, 4), out << "WAVEfmt ", put(16, 4);
  put(1, 2), put(1, 2), put(kSampleRateHz, 4), put(2 * kSampleRateHz, 4), put(2, 2), put(16, 2);
  out << "data", put(kBytes, 4);
  for (int n = 0; n < kSeconds * kSampleRateHz; ++n) {
    const double t = static_cast<double>(n) / kSampleRateHz;
    const auto value = std::lrint(9000 * std::sin(900 * t) * (0.5 + 0.5 * std::sin(12 * t)));
    put(static_cast<std::uint32_t>(value) & 0xffffu, 2);
  }
}

/// The files of all runs, in a folder that goes with the program.
class Inputs {
 public:
  Inputs() : folder_(fs::temp_directory_path() / ("mien_said_bench_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    write_said(folder_ / "said.safetensors");
    write_sound(folder_ / "speech.wav");
  }
  ~Inputs() { fs::remove_all(folder_); }
  Inputs(const Inputs&) = delete;
  Inputs& operator=(const Inputs&) = delete;
  [[nodiscard]] const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

/// Seconds of processor of all programs that this one has started and waited for.
double processor_seconds() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// Arguments: steps, precision (f32, bf16, int8).
void animate(benchmark::State& state) {
  if (!fs::exists(program())) return state.SkipWithError("there is no mien beside this program");
  static const Inputs inputs;
  constexpr const char* kPrecisions[] = {"f32", "bf16", "int8"};
  const std::string folder = inputs.folder().string();
  const std::string command = "'" + program().string() + "' animate '" + folder + "/speech.wav' --model '" +
                              folder + "/said.safetensors' --steps " + std::to_string(state.range(0)) +
                              " --precision " + kPrecisions[state.range(1)] + " --threads 2 --quiet -o '" +
                              folder + "/out.said.csv'";
  const double before = processor_seconds();
  for (auto _ : state)
    if (std::system(command.c_str()) != 0) return state.SkipWithError("mien animate failed");
  state.counters["processor_s"] = (processor_seconds() - before) / static_cast<double>(state.iterations());
  state.counters["real_time_factor"] =
      benchmark::Counter(kSeconds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(animate)
    ->Name("said/program")
    ->ArgNames({"steps", "precision"})
    ->ArgsProduct({{50, 1000}, {0, 1}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace mien
