#pragma once
#include <memory>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "input_file.h"

namespace mien {

struct AvDelete {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVIOContext* io) const {
    av_freep(&io->buffer);  // libavformat may have replaced the buffer it was given
    avio_context_free(&io);
  }
};
template <class T>
using AvPtr = std::unique_ptr<T, AvDelete>;

/// libavformat on top of an InputFile: it sees bytes only, so a name is never taken for an address, and a
/// file cannot make it open another one. Not movable: libavformat keeps its address.
class AvInput {
 public:
  explicit AvInput(InputFile file) : file_(std::move(file)) {}
  AvInput(const AvInput&) = delete;
  AvInput& operator=(const AvInput&) = delete;

  /// Recognises the container and finds its sound track. Errors: see make_av_source.
  Status open(const std::string& content);

  [[nodiscard]] InputFile& file() { return file_; }
  [[nodiscard]] AVFormatContext* format() const { return format_.get(); }
  [[nodiscard]] AVStream* stream() const { return stream_; }

 private:
  static int read_bytes(void* self, std::uint8_t* out, int size);
  static std::int64_t seek(void* self, std::int64_t offset, int whence);

  InputFile file_;
  AvPtr<AVIOContext> io_;
  AvPtr<AVFormatContext> format_;  // after io_: closed first
  AVStream* stream_ = nullptr;
};

/// libav's words for one of its error codes.
std::string av_message(int error);

}  // namespace mien
