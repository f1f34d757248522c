#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

/// What reads outside bytes, one function for each, to be fed with any bytes: by libFuzzer, and by fuzz_test with the
/// committed corpus.
///
/// A target returns, whatever the bytes are: what it throws, such as a Finding (input.hpp), is a mistake of ours. It
/// keeps no state between calls, takes no time from the machine, and writes nothing but files in a folder of its own
/// below the system's folder for temporary files.
namespace forcebound::fuzz {

using Bytes = std::span<const std::byte>;

void fuzz_client(Bytes bytes);                ///< a script of answers, times and places, fed to the client's session
void fuzz_compressed_recording(Bytes bytes);  ///< a compressed chunk of a recording; the first byte says of what
void fuzz_csv(Bytes bytes);                   ///< a table of numbers of forcebound-lab
void fuzz_device(Bytes bytes);                ///< a device's TOML file
void fuzz_encryption(Bytes bytes);            ///< a script of what a network does between both ends of encryption
void fuzz_gmsh(Bytes bytes);                  ///< a mesh of tetrahedra
void fuzz_hand(Bytes bytes);                  ///< a recorded hand
void fuzz_handover(Bytes bytes);              ///< a scene as a server hands it over: the manifest, its hash made right
void fuzz_height_field(Bytes bytes);          ///< heights in a file of comma-separated numbers
void fuzz_keys(Bytes bytes);                  ///< files of keys and datagrams of handshakes; the first byte says which
void fuzz_laws(Bytes bytes);                  ///< a TOML file of laws' parameters
void fuzz_mesh(Bytes bytes);                  ///< a mesh; the first byte says whether it is OBJ, OFF or STL
void fuzz_mjcf(Bytes bytes);                  ///< MJCF, before MuJoCo sees it
void fuzz_recording(Bytes bytes);             ///< a recording, and the summary of its ticks
void fuzz_scene(Bytes bytes);                 ///< a scene's TOML file
void fuzz_server(Bytes bytes);                ///< a script of datagrams, times and addresses, fed to the server
void fuzz_summary(Bytes bytes);               ///< what --summary wrote, and the table of it
void fuzz_toml(Bytes bytes);                  ///< TOML itself, and a value as after KEY =
void fuzz_trace(Bytes bytes);                 ///< a network's delays or opportunities as they were measured
void fuzz_view(Bytes bytes);                  ///< how a scene looks, as a server tells, and what moves in it
void fuzz_wire(Bytes bytes);                  ///< a datagram; the first byte is its kind, the checksum is made right
void fuzz_words(Bytes bytes);                 ///< words of a command line: network, endpoints, a simulated hand

struct Target {
  std::string_view name;  ///< of its folder in corpus/
  void (*run)(Bytes bytes);
};

inline constexpr std::array kTargets{
    Target{"client", fuzz_client},
    Target{"compressed_recording", fuzz_compressed_recording},
    Target{"csv", fuzz_csv},
    Target{"device", fuzz_device},
    Target{"encryption", fuzz_encryption},
    Target{"gmsh", fuzz_gmsh},
    Target{"hand", fuzz_hand},
    Target{"handover", fuzz_handover},
    Target{"height_field", fuzz_height_field},
    Target{"keys", fuzz_keys},
    Target{"laws", fuzz_laws},
    Target{"mesh", fuzz_mesh},
#ifdef FORCEBOUND_FUZZ_MUJOCO
    Target{"mjcf", fuzz_mjcf},
#endif
    Target{"recording", fuzz_recording},
    Target{"scene", fuzz_scene},
    Target{"server", fuzz_server},
    Target{"summary", fuzz_summary},
    Target{"toml", fuzz_toml},
    Target{"trace", fuzz_trace},
    Target{"view", fuzz_view},
    Target{"wire", fuzz_wire},
    Target{"words", fuzz_words},
};

}  // namespace forcebound::fuzz
