// Presses a simulated device into the wall of a server, and prints what was felt and the least P.
//
//     forcebound-server --scene wall & forcebound-relay --listen 127.0.0.1:47900 --upstream 127.0.0.1:47800 &
//     mcs -unsafe ../Forcebound.cs FeelAWall.cs -out:FeelAWall.exe
//     LD_LIBRARY_PATH=.../build/release/lib mono FeelAWall.exe 127.0.0.1:47900
using System;
using System.Globalization;
using System.Threading;
using Forcebound;

static class FeelAWall {
  const double Duration_s = 4;
  const int LookEach_ms = 50;

  static int Main(string[] arguments) {
    Thread.CurrentThread.CurrentCulture = CultureInfo.InvariantCulture;
    if (arguments.Length < 1 || arguments.Length > 2) {
      Console.Error.WriteLine("usage: FeelAWall.exe HOST:PORT [LAW]");
      return 2;
    }
    try {
      return Feel(arguments[0], arguments.Length == 2 ? arguments[1] : "fba-exact");
    } catch (Exception e) when (e is ForceboundException || e is DllNotFoundException) {
      Console.Error.WriteLine(e.Message);
      return 1;
    }
  }

  static int Feel(string server, string law) {
    var settings = new ClientSettings { Server = server, Law = law, Duration_s = Duration_s, RemoteRendering = true,
                                        Once = true };
    using (Device device = Device.Open("wall-1dof", "press"))
    using (var client = new Client(settings, device)) {
      client.Start();
      var state = new ClientState();
      double deepest_m = 0, largest_N = 0;
      while (!client.Wait(LookEach_ms / 1000.0)) {
        client.Look(state);
        deepest_m = Math.Max(deepest_m, state.Position_m[0]);
        largest_N = Math.Max(largest_N, -state.Force_N[0]);
        while (client.TryTake(out Event happened)) Console.WriteLine(happened);
      }
      client.Look(state);
      Ledger ledger = client.Ledger();
      Console.WriteLine("{0}: {1} ticks, {2:F2} mm deep in the wall, {3:F2} N, least P {4:F3} mJ", law, state.Ticks,
                        1e3 * deepest_m, largest_N, 1e3 * ledger.LeastP_J);
      return ledger.LeastP_J < 0 ? 3 : 0;
    }
  }
}
