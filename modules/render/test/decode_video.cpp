#include "decode_video.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace mien::render_test {
namespace {

struct Decoder {
  AVCodecContext* context = nullptr;
  AVRational time_base{};
};

void take_frame(const AVFrame& frame, const Decoder& decoder, DecodedVideo& out) {
  const double start = static_cast<double>(frame.best_effort_timestamp) * av_q2d(decoder.time_base);
  if (decoder.context->codec_type == AVMEDIA_TYPE_VIDEO) {
    DecodedVideo::Frame f{start, static_cast<double>(frame.pkt_duration) * av_q2d(decoder.time_base), {}};
    out.width = frame.width, out.height = frame.height;
    for (int y = 0; y < frame.height; ++y)
      f.luma.insert(f.luma.end(), frame.data[0] + y * frame.linesize[0],
                    frame.data[0] + y * frame.linesize[0] + frame.width);
    out.frames.push_back(std::move(f));
    return;
  }
  if (out.sound.empty()) out.sound_start = start;
  out.sound_rate_hz = frame.sample_rate;
  for (int i = 0; i < frame.nb_samples; ++i) {
    if (frame.format == AV_SAMPLE_FMT_FLTP || frame.format == AV_SAMPLE_FMT_FLT)
      out.sound.push_back(reinterpret_cast<const float*>(frame.data[0])[i]);
    else if (frame.format == AV_SAMPLE_FMT_S16P || frame.format == AV_SAMPLE_FMT_S16)
      out.sound.push_back(static_cast<float>(reinterpret_cast<const std::int16_t*>(frame.data[0])[i]) /
                          32768.0f);
  }
}

}  // namespace

DecodedVideo decode_video(const std::filesystem::path& path) {
  DecodedVideo out;
  AVFormatContext* file = nullptr;
  if (avformat_open_input(&file, path.c_str(), nullptr, nullptr) < 0) return out;
  avformat_find_stream_info(file, nullptr);
  out.seconds = static_cast<double>(file->duration) / AV_TIME_BASE;
  std::vector<Decoder> decoders(file->nb_streams);
  for (unsigned i = 0; i < file->nb_streams; ++i) {
    const AVStream& stream = *file->streams[i];
    const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
    Decoder& d = decoders[i];
    d.context = avcodec_alloc_context3(codec);
    d.time_base = stream.time_base;
    avcodec_parameters_to_context(d.context, stream.codecpar);
    d.context->pkt_timebase = stream.time_base;
    d.context->thread_count = 1;
    avcodec_open2(d.context, codec, nullptr);
  }
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  const auto receive = [&](Decoder& d) {
    while (avcodec_receive_frame(d.context, frame) >= 0) take_frame(*frame, d, out);
  };
  while (av_read_frame(file, packet) >= 0) {
    Decoder& d = decoders[static_cast<std::size_t>(packet->stream_index)];
    out.packet_times.push_back(static_cast<double>(packet->dts) * av_q2d(d.time_base));
    out.packet_durations.push_back(static_cast<double>(packet->duration) * av_q2d(d.time_base));
    out.packet_is_video.push_back(d.context->codec_type == AVMEDIA_TYPE_VIDEO);
    avcodec_send_packet(d.context, packet);
    receive(d);
    av_packet_unref(packet);
  }
  for (Decoder& d : decoders) {
    avcodec_send_packet(d.context, nullptr);
    receive(d);
    avcodec_free_context(&d.context);
  }
  av_frame_free(&frame);
  av_packet_free(&packet);
  avformat_close_input(&file);
  return out;
}

}  // namespace mien::render_test
