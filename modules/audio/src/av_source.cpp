#include "av_source.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "av_input.h"
#include "mien/base/number_text.h"
#include "ogg_end.h"

namespace mien {
namespace {

constexpr double kMinGapSeconds = 0.02;      // shorter jumps of the time stamps are rounding
constexpr double kMaxGapSeconds = 10.0;      // longer ones are broken clocks
constexpr double kLossySlackSeconds = 0.05;  // lossy codings pad and trim by a packet or two
constexpr std::int64_t kSilenceFrames = 4096;

template <class T>
void interleave(const AVFrame& frame, bool is_planar, double offset, double scale, std::vector<float>& out) {
  const int channels = frame.ch_layout.nb_channels;
  std::size_t k = 0;
  for (int i = 0; i < frame.nb_samples; ++i) {
    for (int c = 0; c < channels; ++c) {
      const auto* plane = reinterpret_cast<const T*>(frame.extended_data[is_planar ? c : 0]);
      const T x = plane[is_planar ? i : i * channels + c];
      out[k++] = static_cast<float>((static_cast<double>(x) - offset) * scale);
    }
  }
}

// False for a sample format that this code does not know.
bool convert(const AVFrame& frame, SoundBlock& block) {
  block.num_channels = frame.ch_layout.nb_channels;
  block.samples.resize(static_cast<std::size_t>(frame.nb_samples) *
                       static_cast<std::size_t>(block.num_channels));
  const auto format = static_cast<AVSampleFormat>(frame.format);
  const bool is_planar = av_sample_fmt_is_planar(format) != 0;
  switch (av_get_packed_sample_fmt(format)) {
    case AV_SAMPLE_FMT_U8:
      interleave<std::uint8_t>(frame, is_planar, 128, std::ldexp(1.0, -7), block.samples);
      return true;
    case AV_SAMPLE_FMT_S16:
      interleave<std::int16_t>(frame, is_planar, 0, std::ldexp(1.0, -15), block.samples);
      return true;
    case AV_SAMPLE_FMT_S32:
      interleave<std::int32_t>(frame, is_planar, 0, std::ldexp(1.0, -31), block.samples);
      return true;
    case AV_SAMPLE_FMT_S64:
      interleave<std::int64_t>(frame, is_planar, 0, std::ldexp(1.0, -63), block.samples);
      return true;
    case AV_SAMPLE_FMT_FLT:
      interleave<float>(frame, is_planar, 0, 1.0, block.samples);
      return true;
    case AV_SAMPLE_FMT_DBL:
      interleave<double>(frame, is_planar, 0, 1.0, block.samples);
      return true;
    default:
      return false;
  }
}

class AvSource final : public SoundSource {
 public:
  explicit AvSource(InputFile file) : input_(std::move(file)) {}

  Status open(const std::string& content) {
    MIEN_TRY([[maybe_unused]] const Done opened, input_.open(content));
    const AVCodecParameters& parameters = *input_.stream()->codecpar;
    const std::string coding = avcodec_get_name(parameters.codec_id);
    const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
    if (codec == nullptr)
      return input_.file().error("no decoder for its sound coding '" + coding + "'", kAcceptedFormats);
    decoder_.reset(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(decoder_.get(), &parameters);
    decoder_->pkt_timebase = input_.stream()->time_base;
    decoder_->thread_count = 1;
    const AVCodecDescriptor* descriptor = avcodec_descriptor_get(parameters.codec_id);
    const int props = descriptor != nullptr ? descriptor->props : 0;
    is_lossless_ = (props & AV_CODEC_PROP_LOSSLESS) != 0 && (props & AV_CODEC_PROP_LOSSY) == 0;
    // A lossless packet with a wrong check sum would be heard as a burst of noise: rather drop it.
    if (is_lossless_) decoder_->err_recognition = AV_EF_CRCCHECK | AV_EF_EXPLODE;
    if (const int error = avcodec_open2(decoder_.get(), codec, nullptr); error < 0)
      return input_.file().error("damaged header of its sound coding '" + coding + "': " + av_message(error));

    // The first frame tells rate and channels as they come out of the decoder; headers are not to be trusted.
    MIEN_TRY([[maybe_unused]] const Done decoded, decode_frame());
    if (is_over_)
      return input_.file().error("no sound could be decoded from its '" + coding + "' track" +
                                 (warnings_.empty() ? "" : ": " + warnings_.front()));
    const std::string container = input_.format()->iformat->name;
    info_ = {.format = container == coding ? container : container + ", " + coding,
             .sample_rate_hz = frame_->sample_rate,
             .num_channels = frame_->ch_layout.nb_channels,
             .seconds = declared_seconds()};
    return Done{};
  }

  Status read(SoundBlock& block) override {
    block.num_channels = frame_->ch_layout.nb_channels;
    block.samples.clear();
    if (is_over_) return Done{};
    if (silence_left_ > 0) {
      const std::int64_t n = std::min(silence_left_, kSilenceFrames);
      silence_left_ -= n;
      count_frames(n);
      block.samples.assign(static_cast<std::size_t>(n * block.num_channels), 0.0f);
      return Done{};
    }
    if (!convert(*frame_, block))
      return input_.file().error("its sound coding gives samples of an unknown kind", kAcceptedFormats);
    count_frames(frame_->nb_samples);
    return decode_frame();
  }

 private:
  void count_frames(std::int64_t n) { num_frames_ += n; }

  std::optional<double> declared_seconds() const {
    const AVStream& stream = *input_.stream();
    // A duration guessed from the bit rate is worth nothing.
    if (stream.duration == AV_NOPTS_VALUE || stream.duration <= 0 ||
        input_.format()->duration_estimation_method == AVFMT_DURATION_FROM_BITRATE)
      return std::nullopt;
    return static_cast<double>(stream.duration) * av_q2d(stream.time_base);
  }

  // Next decoded frame into frame_, with the silence that goes before it; or is_over_.
  Status decode_frame() {
    for (;;) {
      const int error = avcodec_receive_frame(decoder_.get(), frame_.get());
      if (error == 0) {
        if (frame_->nb_samples <= 0) continue;
        return take_frame();
      }
      if (error == AVERROR_EOF) {
        end();
        return Done{};
      }
      if (error != AVERROR(EAGAIN)) {
        note_damage();
        if (is_flushing_) {
          end();
          return Done{};
        }
      }
      send_packet();
    }
  }

  void send_packet() {
    int error = 0;
    do {
      av_packet_unref(packet_.get());
      error = av_read_frame(input_.format(), packet_.get());
    } while (error >= 0 && packet_->stream_index != input_.stream()->index);
    if (error < 0) {
      if (error != AVERROR_EOF) ++num_damaged_;
      is_flushing_ = true;
      avcodec_send_packet(decoder_.get(), nullptr);
      return;
    }
    note_span();
    if ((packet_->flags & AV_PKT_FLAG_CORRUPT) != 0 || avcodec_send_packet(decoder_.get(), packet_.get()) < 0)
      note_damage();
  }

  // Time covered by the packets, with the padding of encoders that decoders cut off again.
  void note_span() {
    if (packet_->pts == AV_NOPTS_VALUE) return;
    const double unit = av_q2d(input_.stream()->time_base);
    if (!first_packet_) first_packet_ = static_cast<double>(packet_->pts) * unit;
    const auto end =
        static_cast<double>(packet_->pts) + static_cast<double>(std::max<std::int64_t>(0, packet_->duration));
    packet_span_ = std::max(packet_span_, end * unit - *first_packet_);
  }

  void note_damage() {
    ++num_damaged_;
    // Lost before anything was decoded: the sound starts here all the same.
    if (!next_stamp_ && num_frames_ == 0 && packet_->pts != AV_NOPTS_VALUE)
      next_stamp_ = static_cast<double>(packet_->pts) * av_q2d(input_.stream()->time_base);
  }

  Status take_frame() {
    const int channels = frame_->ch_layout.nb_channels;
    const int rate = frame_->sample_rate;
    if (channels < 1 || channels > kMaxChannels)
      return input_.file().error("it has " + std::to_string(channels) + " channels, expected 1 to " +
                                 std::to_string(kMaxChannels));
    if (rate < kMinSampleRateHz || rate > kMaxSampleRateHz)
      return input_.file().error("its sample rate is " + std::to_string(rate) + " Hz, expected " +
                                 std::to_string(kMinSampleRateHz) + " to " +
                                 std::to_string(kMaxSampleRateHz));
    if (info_.sample_rate_hz != 0 && rate != info_.sample_rate_hz)
      return input_.file().error("its sample rate changes from " + std::to_string(info_.sample_rate_hz) +
                                     " to " + std::to_string(rate) + " Hz after " + seconds_text(),
                                 "Convert it to one rate");
    fill_gap(rate);
    return Done{};
  }

  // A packet that was lost or unreadable leaves a jump in the time stamps. Silence in its place keeps all
  // later sound, and with it the lips, on time.
  void fill_gap(int rate) {
    const std::int64_t stamp = frame_->best_effort_timestamp;
    if (stamp == AV_NOPTS_VALUE) {
      next_stamp_.reset();
      return;
    }
    const double start = static_cast<double>(stamp) * av_q2d(input_.stream()->time_base);
    const double gap = next_stamp_ ? start - *next_stamp_ : 0.0;
    next_stamp_ = start + static_cast<double>(frame_->nb_samples) / rate;
    if (gap < kMinGapSeconds) return;
    if (gap > kMaxGapSeconds) {
      ++num_jumps_;
      return;
    }
    silence_left_ = std::llround(gap * rate);
    filled_seconds_ += gap;
  }

  void end() {
    is_over_ = true;
    if (filled_seconds_ > 0)
      warnings_.push_back("the file has holes; " + fixed(filled_seconds_, 3) + " s were replaced by silence");
    else if (num_damaged_ > 0)
      warnings_.push_back("the file is damaged: " + std::to_string(num_damaged_) +
                          " packets could not be decoded");
    if (num_jumps_ > 0)
      warnings_.push_back("the time stamps jump " + std::to_string(num_jumps_) + " times by more than " +
                          fixed(kMaxGapSeconds, 0) + " s; the jumps are ignored");
    if (std::string_view(input_.format()->iformat->name) == "ogg" && !ogg_is_complete(input_.file()))
      warnings_.push_back("the file is cut: its last page is missing; it ends after " + seconds_text());
    if (!info_.seconds) return;
    const double found = static_cast<double>(num_frames_) / info_.sample_rate_hz;
    const double missing = *info_.seconds - (is_lossless_ ? found : std::max(found, packet_span_));
    if (missing > (is_lossless_ ? 0.5 / info_.sample_rate_hz : kLossySlackSeconds))
      warnings_.push_back("the file is cut or damaged: its header declares " + fixed(*info_.seconds, 3) +
                          " s, found " + seconds_text());
  }

  std::string seconds_text() const {
    return fixed(info_.sample_rate_hz == 0 ? 0.0 : static_cast<double>(num_frames_) / info_.sample_rate_hz,
                 3) +
           " s";
  }

  AvInput input_;
  AvPtr<AVCodecContext> decoder_;
  AvPtr<AVPacket> packet_{av_packet_alloc()};
  AvPtr<AVFrame> frame_{av_frame_alloc()};  // the next frame to give, until is_over_
  bool is_lossless_ = false;
  bool is_flushing_ = false;
  bool is_over_ = false;
  std::int64_t num_frames_ = 0;         // given so far
  std::int64_t silence_left_ = 0;       // frames to give before frame_
  std::optional<double> next_stamp_;    // seconds, where the last frame ended
  std::optional<double> first_packet_;  // seconds
  double packet_span_ = 0;
  double filled_seconds_ = 0;
  std::int64_t num_damaged_ = 0;
  std::int64_t num_jumps_ = 0;
};

}  // namespace

Result<std::unique_ptr<SoundSource>> make_av_source(InputFile file, const std::string& content) {
  auto source = std::make_unique<AvSource>(std::move(file));
  MIEN_TRY([[maybe_unused]] const Done opened, source->open(content));
  return std::unique_ptr<SoundSource>(std::move(source));
}

}  // namespace mien
