#pragma once
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include <memory>
#include <string>

#include "mien/base/result.h"

namespace mien::render_detail {

struct AvDelete {
  void operator()(AVFormatContext* context) const {
    if (context->pb != nullptr && (context->oformat->flags & AVFMT_NOFILE) == 0) avio_closep(&context->pb);
    avformat_free_context(context);
  }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
template <class T>
using AvPointer = std::unique_ptr<T, AvDelete>;

/// libav's text for one of its error numbers.
std::string av_reason(int error_number);

/// One encoder and its stream in the file.
struct AvTrack {
  AvPointer<AVCodecContext> encoder;
  AvPointer<AVFrame> frame;
  AVStream* stream = nullptr;
};

/// What both kinds of track need to open an encoder: "libx264", for the file's container.
/// Errors (Errc::failed): this libav has no such encoder, or it is of the other kind.
Result<AvTrack> make_track(AVFormatContext& file, const std::string& encoder_name, AVMediaType type);

/// Opens the encoder and copies what it decided into the stream; the encoder's time base must be set.
Status open_track(AvTrack& track);

/// Sends one frame (nullptr: drain) and writes the packets that come out. Every packet gets a duration:
/// without one the last frame of a file has none, and the file ends too early.
Status encode(AVFormatContext& file, AvTrack& track, const AVFrame* frame, AVPacket& scratch);

/// libav speaks on stderr unless told not to; a library does not print.
void silence_libav();

}  // namespace mien::render_detail
