#include "av.h"

#include <mutex>

namespace mien::render_detail {

std::string av_reason(int error_number) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  return av_make_error_string(text, sizeof text, error_number);
}

void silence_libav() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_level(AV_LOG_QUIET); });
}

Result<AvTrack> make_track(AVFormatContext& file, const std::string& encoder_name, AVMediaType type) {
  const AVCodec* codec = avcodec_find_encoder_by_name(encoder_name.c_str());
  if (codec == nullptr || codec->type != type)
    return Error{Errc::failed, "encoder '" + encoder_name + "'",
                 std::string("the installed libavcodec has no such ") +
                     (type == AVMEDIA_TYPE_VIDEO ? "video" : "sound") + " encoder",
                 "Write the other kind of file (.mp4 or .webm), or install a libavcodec that has it"};
  AvTrack track;
  track.encoder.reset(avcodec_alloc_context3(codec));
  track.frame.reset(av_frame_alloc());
  track.stream = avformat_new_stream(&file, nullptr);
  if (!track.encoder || !track.frame || track.stream == nullptr)
    return Error{Errc::failed, "encoder '" + encoder_name + "'", "out of memory", ""};
  track.encoder->thread_count = 1;
  track.encoder->flags |= AV_CODEC_FLAG_BITEXACT;
  if ((file.oformat->flags & AVFMT_GLOBALHEADER) != 0) track.encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  return track;
}

Status open_track(AvTrack& track) {
  const std::string name = "encoder '" + std::string(track.encoder->codec->name) + "'";
  int failure = avcodec_open2(track.encoder.get(), track.encoder->codec, nullptr);
  if (failure < 0) return Error{Errc::failed, name, "cannot be opened: " + av_reason(failure), ""};
  failure = avcodec_parameters_from_context(track.stream->codecpar, track.encoder.get());
  if (failure < 0) return Error{Errc::failed, name, av_reason(failure), ""};
  track.stream->time_base = track.encoder->time_base;
  return Done{};
}

Status encode(AVFormatContext& file, AvTrack& track, const AVFrame* frame, AVPacket& scratch) {
  const auto failed = [&track](const char* what, int number) {
    return Error{Errc::failed, std::string("encoder '") + track.encoder->codec->name + "'",
                 std::string(what) + ": " + av_reason(number), ""};
  };
  const int sent = avcodec_send_frame(track.encoder.get(), frame);
  if (sent < 0) return failed("refused a frame", sent);
  for (;;) {
    const int received = avcodec_receive_packet(track.encoder.get(), &scratch);
    if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return Done{};
    if (received < 0) return failed("failed", received);
    if (scratch.duration <= 0)
      scratch.duration = track.encoder->codec_type == AVMEDIA_TYPE_VIDEO ? 1 : track.encoder->frame_size;
    scratch.stream_index = track.stream->index;
    av_packet_rescale_ts(&scratch, track.encoder->time_base, track.stream->time_base);
    const int written = av_interleaved_write_frame(&file, &scratch);  // takes the packet's content
    if (written < 0) return failed("writing the file failed", written);
  }
}

}  // namespace mien::render_detail
