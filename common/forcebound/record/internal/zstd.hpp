#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct ZSTD_CCtx_s;

/// Zstandard (RFC 8878) for the chunks of a recording. Private to this folder.
namespace forcebound::record::mcap {

/// Compresses chunk after chunk, each a frame of its own, with the memory of the one before. Not thread-safe.
class Compressor {
 public:
  Compressor();
  ~Compressor();

  /// Nothing: there is no memory for it, or the bytes would not get fewer. Valid until the next call.
  [[nodiscard]] std::optional<std::string_view> compress(std::string_view bytes);

 private:
  struct Free {
    void operator()(ZSTD_CCtx_s* context) const noexcept;
  };
  std::unique_ptr<ZSTD_CCtx_s, Free> context_;
  std::string frame_;
};

/// What a frame, which may be cut off or damaged, holds.
struct Decompressed {
  std::string bytes;    ///< at most those allowed
  std::string problem;  ///< why there are no more; empty: the frame ended well
};

/// Never allocates more than `most` for the result, whatever the frame says of itself.
[[nodiscard]] Decompressed decompress(std::string_view frame, std::size_t most);

}  // namespace forcebound::record::mcap
