#include "mien/render/video.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "av.h"
#include "mien/base/file.h"
#include "yuv.h"

namespace mien {
namespace {

using namespace render_detail;

struct Container {
  const char* extension;
  const char* video_encoder;
  const char* sound_encoder;
  bool is_matroska;
};
constexpr Container kContainers[] = {{".mp4", "libx264", "aac", false},
                                     {".webm", "libvpx-vp9", "libopus", true}};

const Container* container_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Container& c : kContainers)
    if (extension == c.extension) return &c;
  return nullptr;
}

std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

Status validate(const VideoOptions& o) {
  for (const auto& [name, value] : {std::pair("width", o.width), std::pair("height", o.height)})
    if (value < 16 || value > 8192 || value % 2 != 0)
      return Error{Errc::usage, std::string("video ") + name,
                   "is " + std::to_string(value) + " pixels, expected an even number from 16 to 8192", ""};
  if (!(o.fps >= 1 && o.fps <= 240))
    return Error{Errc::usage, "video frame rate", "expected 1 to 240 frames a second", ""};
  if (o.sound_rate_hz < 0 || o.sound_rate_hz > 192000)
    return Error{Errc::usage, "video sound", "the sample rate must lie between 0 and 192000 Hz", ""};
  return Done{};
}

Result<AvTrack> video_track(AVFormatContext& file, const VideoOptions& o, const std::string& name) {
  MIEN_TRY(AvTrack track, make_track(file, name, AVMEDIA_TYPE_VIDEO));
  AVCodecContext& c = *track.encoder;
  c.width = o.width, c.height = o.height;
  c.pix_fmt = AV_PIX_FMT_YUV420P;
  c.framerate = av_d2q(o.fps, 1001000);
  c.time_base = av_inv_q(c.framerate);
  c.gop_size = 30;
  c.color_range = AVCOL_RANGE_MPEG;
  c.colorspace = AVCOL_SPC_BT709;
  c.color_primaries = AVCOL_PRI_BT709;
  c.color_trc = AVCOL_TRC_BT709;
  c.chroma_sample_location = AVCHROMA_LOC_CENTER;
  // Each encoder takes the ones it knows.
  av_opt_set(c.priv_data, "preset", "veryfast", 0);
  av_opt_set(c.priv_data, "crf", name == "libx264" ? "23" : "31", 0);
  av_opt_set(c.priv_data, "deadline", "realtime", 0);
  av_opt_set(c.priv_data, "cpu-used", "8", 0);
  MIEN_TRY([[maybe_unused]] const auto opened, open_track(track));
  track.stream->avg_frame_rate = c.framerate;
  AVFrame& f = *track.frame;
  f.format = c.pix_fmt, f.width = c.width, f.height = c.height;
  f.color_range = c.color_range, f.colorspace = c.colorspace;
  if (av_frame_get_buffer(&f, 0) < 0) return Error{Errc::failed, "video", "out of memory", ""};
  return track;
}

Result<AvTrack> sound_track(AVFormatContext& file, const VideoOptions& o, const std::string& name) {
  MIEN_TRY(AvTrack track, make_track(file, name, AVMEDIA_TYPE_AUDIO));
  AVCodecContext& c = *track.encoder;
  // Mono needs no shuffling: packed and planar floats are the same.
  c.sample_fmt = AV_SAMPLE_FMT_NONE;
  for (const AVSampleFormat* f = c.codec->sample_fmts; f != nullptr && *f != AV_SAMPLE_FMT_NONE; ++f)
    if (*f == AV_SAMPLE_FMT_FLT || *f == AV_SAMPLE_FMT_FLTP) c.sample_fmt = *f;
  if (c.sample_fmt == AV_SAMPLE_FMT_NONE)
    return Error{Errc::failed, "encoder '" + name + "'", "does not take floating-point samples", ""};
  std::string rates;
  bool is_known = c.codec->supported_samplerates == nullptr;
  for (const int* rate = c.codec->supported_samplerates; rate != nullptr && *rate != 0; ++rate) {
    is_known = is_known || *rate == o.sound_rate_hz;
    rates += (rates.empty() ? "" : ", ") + std::to_string(*rate);
  }
  if (!is_known)
    return Error{Errc::failed, "encoder '" + name + "'",
                 "does not take sound at " + std::to_string(o.sound_rate_hz) + " Hz, only at " + rates,
                 "Resample the sound to one of these"};
  c.sample_rate = o.sound_rate_hz;
  c.ch_layout = AV_CHANNEL_LAYOUT_MONO;
  c.time_base = {1, o.sound_rate_hz};
  c.bit_rate = o.sound_rate_hz >= 32000 ? 96000 : 64000;
  MIEN_TRY([[maybe_unused]] const auto opened, open_track(track));
  AVFrame& f = *track.frame;
  f.format = c.sample_fmt, f.sample_rate = c.sample_rate;
  f.nb_samples = c.frame_size > 0 ? c.frame_size : 1024;
  if (av_channel_layout_copy(&f.ch_layout, &c.ch_layout) < 0 || av_frame_get_buffer(&f, 0) < 0)
    return Error{Errc::failed, "video sound", "out of memory", ""};
  return track;
}

}  // namespace

struct VideoWriter::State {
  explicit State(AtomicFile target, std::filesystem::path name)
      : output(std::move(target)), path(std::move(name)) {}

  // Encodes the pending sound that begins before `seconds`, in pieces of the encoder's size; all of it when
  // `is_last`.
  Status write_sound_until(double seconds, bool is_last) {
    AVFrame& frame = *sound.frame;
    const auto piece = static_cast<std::size_t>(piece_size);
    std::size_t used = 0;
    while (used < pending.size() && (is_last || pending.size() - used >= piece) &&
           (is_last || static_cast<double>(num_samples) / sound.encoder->sample_rate < seconds)) {
      if (av_frame_make_writable(&frame) < 0) return Error{Errc::failed, quoted(path), "out of memory", ""};
      const std::size_t count = std::min(piece, pending.size() - used);
      std::copy_n(pending.begin() + static_cast<std::ptrdiff_t>(used), count,
                  reinterpret_cast<float*>(frame.data[0]));
      frame.nb_samples = static_cast<int>(count);
      frame.pts = num_samples;
      MIEN_TRY([[maybe_unused]] const auto done, encode(*file, sound, &frame, *packet));
      used += count;
      num_samples += static_cast<std::int64_t>(count);
    }
    pending.erase(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(used));
    return Done{};
  }
  [[nodiscard]] bool has_sound() const { return sound.encoder != nullptr; }
  [[nodiscard]] double picture_seconds() const {
    return static_cast<double>(num_frames) * av_q2d(video.encoder->time_base);
  }

  AtomicFile output;  // declared first: removed after the file is closed
  std::filesystem::path path;
  AvPointer<AVFormatContext> file;
  AvPointer<AVPacket> packet;
  AvTrack video, sound;
  int piece_size = 0;
  std::vector<float> pending;    // sound whose time has not come
  std::int64_t num_frames = 0;   // given to the encoder
  std::int64_t num_samples = 0;  // given to the encoder
};

Result<VideoWriter> VideoWriter::create(const std::filesystem::path& path, const VideoOptions& options) {
  silence_libav();
  const Container* container = container_of(path);
  if (container == nullptr)
    return Error{Errc::usage, quoted(path), "is not the name of a video", "Use the extension .mp4 or .webm"};
  MIEN_TRY([[maybe_unused]] const auto valid, validate(options));
  MIEN_TRY(auto output, AtomicFile::create(path));
  auto state = std::make_unique<State>(std::move(output), path);
  // "file:" keeps libav from taking a name with a colon for a protocol.
  const std::string target = "file:" + state->output.temporary_path().string();
  AVFormatContext* raw = nullptr;
  int failure = avformat_alloc_output_context2(&raw, nullptr, container->extension + 1, target.c_str());
  state->file.reset(raw);
  state->packet.reset(av_packet_alloc());
  if (failure < 0 || !state->packet)
    return Error{Errc::failed, quoted(path), "libavformat cannot write such files: " + av_reason(failure),
                 ""};
  state->file->flags |= AVFMT_FLAG_BITEXACT;
  // Opus begins with 6.5 ms of warm-up before time zero. The Matroska muxer accounts for them itself; the
  // default would shift the pictures too. (In .mp4 an edit list does it.)
  if (container->is_matroska) state->file->avoid_negative_ts = AVFMT_AVOID_NEG_TS_DISABLED;

  const auto name = [](const std::string& wanted, const char* usual) {
    return wanted.empty() ? usual : wanted;
  };
  auto video = video_track(*raw, options, name(options.video_encoder, container->video_encoder));
  if (!video) return within(video.error(), quoted(path));
  state->video = std::move(*video);
  if (options.sound_rate_hz > 0) {
    auto sound = sound_track(*raw, options, name(options.sound_encoder, container->sound_encoder));
    if (!sound) return within(sound.error(), quoted(path));
    state->sound = std::move(*sound);
    state->piece_size = state->sound.frame->nb_samples;
  }
  failure = avio_open(&raw->pb, target.c_str(), AVIO_FLAG_WRITE);
  if (failure < 0) return Error{Errc::failed, quoted(path), "cannot be written: " + av_reason(failure), ""};
  AVDictionary* header = nullptr;
  av_dict_set(&header, "movflags", "+faststart",
              0);  // the index first: players may start before all is loaded
  failure = avformat_write_header(raw, &header);
  av_dict_free(&header);
  if (failure < 0)
    return Error{Errc::failed, quoted(path), "the header cannot be written: " + av_reason(failure), ""};
  return VideoWriter(std::move(state));
}

VideoWriter::VideoWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

Status VideoWriter::add_frame(const Image& image) {
  State& s = *state_;
  AVFrame& frame = *s.video.frame;
  contract(image.width() == frame.width && image.height() == frame.height,
           "VideoWriter: a frame of another size");
  if (av_frame_make_writable(&frame) < 0) return Error{Errc::failed, quoted(s.path), "out of memory", ""};
  to_yuv420(image, {frame.data[0], frame.data[1], frame.data[2], frame.linesize[0], frame.linesize[1],
                    frame.linesize[2]});
  frame.pts = s.num_frames++;
  const Status done = encode(*s.file, s.video, &frame, *s.packet);
  if (!done) return within(done.error(), quoted(s.path));
  if (!s.has_sound()) return Done{};
  return s.write_sound_until(s.picture_seconds(), false);
}

Status VideoWriter::add_sound(std::span<const float> samples) {
  State& s = *state_;
  contract(s.has_sound(), "VideoWriter: sound for a film without a sound track");
  for (const float v : samples) s.pending.push_back(std::isfinite(v) ? v : 0.0f);
  return s.write_sound_until(s.picture_seconds(), false);
}

Status VideoWriter::finish() {
  State& s = *state_;
  contract(s.file != nullptr, "VideoWriter: finish() was called before");
  if (s.num_frames == 0) return Error{Errc::failed, quoted(s.path), "a video needs at least one frame", ""};
  if (s.has_sound()) {
    MIEN_TRY([[maybe_unused]] const auto written, s.write_sound_until(s.picture_seconds(), true));
  }
  for (AvTrack* track : {&s.video, &s.sound}) {
    if (!track->encoder) continue;
    const Status drained = encode(*s.file, *track, nullptr, *s.packet);
    if (!drained) return within(drained.error(), quoted(s.path));
  }
  int failure = av_write_trailer(s.file.get());
  const int closed = avio_closep(&s.file->pb);
  if (failure >= 0) failure = closed;
  s.file.reset();
  if (failure < 0) return Error{Errc::failed, quoted(s.path), "writing failed: " + av_reason(failure), ""};
  return s.output.commit();
}

bool is_video_path(const std::filesystem::path& path) { return container_of(path) != nullptr; }

}  // namespace mien
