#include "mien/audio/load_audio.h"

#include <algorithm>
#include <array>

#include "av_source.h"
#include "input_file.h"
#include "mien/base/number_text.h"
#include "mono_mixer.h"
#include "resampler.h"
#include "sniff.h"
#include "wav_source.h"

namespace mien {
namespace {

// The decoder for what the file holds, whatever its name says.
Result<std::unique_ptr<SoundSource>> open_source(InputFile file) {
  std::array<std::byte, 4096> buffer;
  const auto head = std::span<const std::byte>(buffer).first(file.read(buffer));
  if (const RiffKind kind = riff_kind(head); kind != RiffKind::none) {
    MIEN_TRY(WavHeader header, read_wav_header(file, kind));
    if (header.coding != WavCoding::other) return make_wav_source(std::move(file), std::move(header));
  } else if (const Sniffed sniffed = sniff(head); sniffed.is_not_sound) {
    return file.error("no sound in it: it is " + sniffed.what,
                      sniffed.fix.empty() ? kAcceptedFormats : sniffed.fix);
  }
  file.seek(0);
  return make_av_source(std::move(file), sniff(head).what);
}

}  // namespace

struct AudioReader::State {
  State(std::filesystem::path file, std::string file_name, std::unique_ptr<SoundSource> opened)
      : path(std::move(file)),
        name(std::move(file_name)),
        source(std::move(opened)),
        mixer(source->info().sample_rate_hz),
        resampler(source->info().sample_rate_hz) {}

  [[nodiscard]] std::size_t num_ready() const { return ready.size() - first; }

  // Decodes until at least `count` samples are ready or the sound is over.
  Status fill(std::size_t count) {
    while (num_ready() < count && !is_over) {
      if (failure) return *failure;
      ready.erase(ready.begin(), ready.begin() + static_cast<std::ptrdiff_t>(first));
      first = 0;
      auto status = source->read(block);
      if (!status) {
        failure = status.error();
      } else if (block.samples.empty()) {
        resampler.finish(ready);
        is_over = true;
      } else if (const auto why = mixer.mix(block, mono)) {
        failure = Error{Errc::input, name, *why, "Repair the recording or export it again"};
      } else {
        resampler.push(mono, ready);
      }
      for (; !has_all_warnings && num_warnings_taken < source->warnings().size(); ++num_warnings_taken)
        warnings.push_back(source->warnings()[num_warnings_taken]);
      if (is_over && !has_all_warnings)
        for (auto& warning : mixer.verdict()) warnings.push_back(std::move(warning));
      if (failure) return *failure;
    }
    return Done{};
  }

  std::filesystem::path path;
  std::string name;
  std::unique_ptr<SoundSource> source;
  MonoMixer mixer;
  Resampler resampler;
  SoundBlock block;
  std::vector<float> mono;
  std::vector<float> ready;  // decoded and not yet given: from `first` on
  std::size_t first = 0;
  bool is_over = false;
  bool was_read = false;
  std::optional<Error> failure;
  std::vector<std::string> warnings;
  std::size_t num_warnings_taken = 0;
  bool has_all_warnings = false;  // of an earlier reading
};

AudioReader::AudioReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
AudioReader::AudioReader(AudioReader&&) noexcept = default;
AudioReader& AudioReader::operator=(AudioReader&&) noexcept = default;
AudioReader::~AudioReader() = default;

Result<AudioReader> AudioReader::open(const std::filesystem::path& path) {
  MIEN_TRY(InputFile file, InputFile::open(path));
  std::string name = file.name();
  MIEN_TRY(auto source, open_source(std::move(file)));
  if (const int rate = source->info().sample_rate_hz; !Resampler::takes(rate))
    return Error{Errc::input, name,
                 "has " + std::to_string(rate) + " Hz, and this program was built without soxr",
                 "Convert it: ffmpeg -i FILE -ac 1 -ar 16000 sound.wav"};
  auto state = std::make_unique<State>(path, std::move(name), std::move(source));
  MIEN_TRY([[maybe_unused]] const Done filled, state->fill(kMinAudioSamples));
  if (state->num_ready() < kMinAudioSamples) {
    std::string why = "too short: at least 25 ms needed, found " +
                      fixed(1000.0 * static_cast<double>(state->num_ready()) / kModelSampleRateHz, 1) +
                      " ms (" + std::to_string(state->num_ready()) + " samples at 16 kHz)";
    if (!state->source->warnings().empty()) why += "; " + state->source->warnings().front();
    return Error{Errc::input, state->name, why, "Choose a longer recording"};
  }
  return AudioReader(std::move(state));
}

Result<std::size_t> AudioReader::read(std::span<float> out) {
  State& s = *state_;
  s.was_read = true;
  std::size_t written = 0;
  while (written < out.size()) {
    // A block at a time, so that a large request does not collect in `ready` first.
    MIEN_TRY([[maybe_unused]] const Done filled, s.fill(1));
    const std::size_t n = std::min(s.num_ready(), out.size() - written);
    if (n == 0) break;
    std::copy_n(s.ready.begin() + static_cast<std::ptrdiff_t>(s.first), n,
                out.begin() + static_cast<std::ptrdiff_t>(written));
    s.first += n;
    written += n;
  }
  return written;
}

Status AudioReader::rewind() {
  if (!state_->was_read) return Done{};
  MIEN_TRY(AudioReader again, open(state_->path));
  if (state_->is_over) {  // its warnings are complete: the same ones come again
    again.state_->warnings = std::move(state_->warnings);
    again.state_->has_all_warnings = true;
  }
  *this = std::move(again);
  return Done{};
}

const AudioInfo& AudioReader::info() const { return state_->source->info(); }
const std::vector<std::string>& AudioReader::warnings() const { return state_->warnings; }

Result<AudioClip> read_all(AudioReader& reader) {
  AudioClip clip;
  std::array<float, 16384> block;
  for (;;) {
    MIEN_TRY(const std::size_t n, reader.read(block));
    clip.samples.insert(clip.samples.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(n));
    if (n < block.size()) break;
  }
  return clip;
}

Result<AudioClip> load_audio(const std::filesystem::path& path) {
  MIEN_TRY(AudioReader reader, AudioReader::open(path));
  auto clip = read_all(reader);
  if (clip) clip.warnings = reader.warnings();
  return clip;
}

}  // namespace mien
