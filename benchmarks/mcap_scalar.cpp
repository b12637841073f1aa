// One scalar of every message of a topic by the C++ library mcap: count and sum, for each file named on standard input.
//
// Usage: mcap_scalar TOPIC. The type begins with a std_msgs/Header and goes on with the double that is read.

#define MCAP_IMPLEMENTATION
#include <mcap/reader.hpp>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

namespace {

// CDR, little-endian: 4 bytes of encapsulation, two of 4 of the stamp, a string, the double at a multiple of 8.
bool scalar(const mcap::Message& message, double& value) {
  const auto* fields = reinterpret_cast<const char*>(message.data) + 4;
  const uint64_t size = message.dataSize < 4 ? 0 : message.dataSize - 4;
  uint32_t length = 0;
  if (size < 12) {
    return false;
  }
  std::memcpy(&length, fields + 8, sizeof length);
  const uint64_t at = (12 + uint64_t{length} + 7) / 8 * 8;
  if (at + sizeof value > size) {
    return false;
  }
  std::memcpy(&value, fields + at, sizeof value);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    return 2;
  }
  const std::string topic = argv[1];
  for (std::string path; std::getline(std::cin, path);) {
    mcap::McapReader reader;
    const auto noted = [](const mcap::Status& status) { std::fprintf(stderr, "%s\n", status.message.c_str()); };
    if (!reader.open(path).ok() || !reader.readSummary(mcap::ReadSummaryMethod::NoFallbackScan, noted).ok()) {
      return 1;
    }
    mcap::ReadMessageOptions options;
    options.topicFilter = [&](std::string_view name) { return name == topic; };
    uint64_t count = 0;
    double sum = 0.0;
    for (const auto& view : reader.readMessages(noted, options)) {
      double value = 0.0;
      if (!scalar(view.message, value)) {
        return 1;
      }
      sum += value;
      ++count;
    }
    std::printf("%llu %.17g\n", static_cast<unsigned long long>(count), sum);
    std::fflush(stdout);
  }
}
