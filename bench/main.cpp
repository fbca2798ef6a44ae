// Benchmarks of the kernels: mien_bench [--benchmark_filter=<regex>] [--benchmark_format=json]
#include <benchmark/benchmark.h>

#include <fstream>
#include <string>

#include "mien/base/parallel.h"
#include "mien/tensor/matmul.h"

namespace {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::AddCustomContext("processor", processor_name());
  benchmark::AddCustomContext("processors usable", std::to_string(mien::hardware_threads()));
  benchmark::AddCustomContext("rowwise instruction set", std::string(mien::rowwise_instruction_set()));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
