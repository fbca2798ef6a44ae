// festival as a separate program that reads a Scheme script. Corpus spec section 1.3.
#include <fcntl.h>
#include <sndfile.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>

#include "engine.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct VoiceFacts {
  const char* folder;  // under kVoiceRoot; absent = the voice is not installed
  const char* select;  // Scheme call
  double f0_mean_hz;   // 0: the voice has no linear F0 model to set
  double f0_spread_hz;
};

constexpr const char* kVoiceRoot = "/usr/share/festival/voices/";
const std::map<std::string, VoiceFacts>& voice_facts() {
  static const std::map<std::string, VoiceFacts> facts = {
      {"kal", {"english/kal_diphone", "(voice_kal_diphone)", 105, 14}},
      {"ked", {"english/ked_diphone", "(voice_ked_diphone)", 105, 15}},
      {"slt_hts", {"us/cmu_us_slt_arctic_hts", "(voice_cmu_us_slt_arctic_hts)", 0, 0}},
  };
  return facts;
}

std::string scheme_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// A folder that disappears with its owner.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "mien-festival-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Runs `festival -b script`, its output thrown away. False when it cannot be started or fails.
bool run_festival(const std::string& script) {
  const pid_t child = ::fork();
  if (child < 0) return false;
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0 || ::dup2(nowhere, STDERR_FILENO) < 0) ::_exit(127);
    ::execlp("festival", "festival", "-b", script.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return false;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

Result<Sentence> read_wave(const fs::path& path) {
  SF_INFO info{};
  SNDFILE* file = sf_open(path.c_str(), SFM_READ, &info);
  if (file == nullptr || info.channels != 1) {
    if (file != nullptr) sf_close(file);
    return Error{Errc::failed, "festival", "it wrote no mono wave", ""};
  }
  Sentence u;
  u.sample_rate_hz = info.samplerate;
  u.samples.resize(static_cast<std::size_t>(info.frames));
  u.samples.resize(
      static_cast<std::size_t>(std::max<sf_count_t>(0, sf_readf_float(file, u.samples.data(), info.frames))));
  sf_close(file);
  if (u.samples.empty()) return Error{Errc::failed, "festival", "it wrote an empty wave", ""};
  return u;
}

// "header ... #" and then "end number phone" per line.
Result<std::vector<LabelledPhone>> read_labels(const fs::path& path, double total) {
  MIEN_TRY(const auto bytes, read_file(path));
  std::istringstream lines{std::string(as_text(bytes))};
  std::vector<LabelledPhone> phones;
  std::string line;
  bool in_body = false;
  double start = 0.0;
  while (std::getline(lines, line)) {
    if (!in_body) {
      in_body = line == "#";
      continue;
    }
    std::istringstream words(line);
    std::string end_text, number, name;
    if (!(words >> end_text >> number >> name)) continue;
    const auto end = parse_double(end_text);
    if (!end) return Error{Errc::failed, "festival", "the label line '" + line + "' has no time", ""};
    const double to = std::clamp(*end, start, total);
    if (to > start) phones.push_back({start, to, name, {}});
    start = to;
  }
  if (phones.empty()) return Error{Errc::failed, "festival", "it wrote no phone labels", ""};
  if (start < total) phones.push_back({start, total, "pau", {}});
  return phones;
}

class Festival final : public Engine {
 public:
  explicit Festival(std::vector<std::string> voices) : voices_(std::move(voices)) {}
  EngineId id() const override { return EngineId::festival; }
  std::string version() const override { return "festival 2.5"; }
  std::vector<std::string> voices() const override { return voices_; }

  Result<Sentence> synthesise(const std::string& text, const std::string& voice, const Speaking& s) override {
    if (std::find(voices_.begin(), voices_.end(), voice) == voices_.end())
      return Error{Errc::usage, "festival voice '" + voice + "'", "not installed", "See mien-corpus list"};
    const auto& facts = voice_facts().at(voice);
    const ScratchFolder scratch;
    if (scratch.path().empty()) return Error{Errc::failed, "festival", "no temporary folder can be made", ""};
    const fs::path wave = scratch.path() / "u.wav", labels = scratch.path() / "u.segs";
    std::string script = std::string(facts.select) + "\n";
    script += "(Parameter.set 'Duration_Stretch " + fixed(1.0 / s.rate, 4) + ")\n";
    if (facts.f0_mean_hz > 0)
      script += "(set! int_lr_params '((target_f0_mean " +
                fixed(facts.f0_mean_hz * (1 + s.pitch_percent / 100), 2) + ") (target_f0_std " +
                fixed(facts.f0_spread_hz * s.range, 2) + ") (model_f0_mean 170) (model_f0_std 34)))\n";
    script += "(set! u (utt.synth (eval (list 'Utterance 'Text " + scheme_string(text) + "))))\n";
    script += "(utt.save.wave u " + scheme_string(wave.string()) + " 'riff)\n";
    script += "(utt.save.segs u " + scheme_string(labels.string()) + ")\n";
    const fs::path script_path = scratch.path() / "u.scm";
    MIEN_TRY(const Done written, write_file(script_path, script));
    (void)written;
    if (!run_festival(script_path.string()))
      return Error{Errc::failed, "festival voice '" + voice + "'", "the program failed on '" + text + "'",
                   ""};
    MIEN_TRY(Sentence u, read_wave(wave));
    const double total = static_cast<double>(u.samples.size()) / u.sample_rate_hz;
    MIEN_TRY(u.phones, read_labels(labels, total));
    return u;
  }

 private:
  std::vector<std::string> voices_;
};

bool is_on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  std::string folder;
  while (std::getline(folders, folder, ':'))
    if (!folder.empty() && ::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace

Result<std::unique_ptr<Engine>> make_festival() {
  if (!is_on_path("festival"))
    return Error{Errc::failed, "festival", "no such program", "Install the package festival"};
  std::vector<std::string> voices;
  std::error_code ignored;
  for (const auto& [name, facts] : voice_facts())
    if (fs::is_directory(fs::path(kVoiceRoot) / facts.folder, ignored)) voices.push_back(name);
  if (voices.empty())
    return Error{Errc::failed, "festival", "none of its voices kal, ked, slt_hts is installed",
                 "Install festvox-kallpc16k, festvox-kdlpc16k or festvox-us-slt-hts"};
  return std::unique_ptr<Engine>(std::make_unique<Festival>(std::move(voices)));
}

}  // namespace mien
