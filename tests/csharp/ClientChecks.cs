// Clients of a real server, with devices of callbacks and of the library.
using System;
using System.Collections.Generic;
using System.Threading;
using Forcebound;

static partial class Checks {
  const string Wall = "kind = \"cartesian\"\ndegrees_of_freedom = 1\ndamping_N_s_per_m = 30\nforce_N_max = 30\n" +
                      "mass_kg = 0.1\nencoder_step_m = 15e-6\n";

  // A hand that presses some tenths of a millimetre into the wall and leaves it, again and again; what it does at a
  // given reading is added.
  sealed class Pressed {
    public readonly List<double> Commands_N = new List<double>();
    public Action<int> At = reading => {};
    public int Readings;
    public int Done;
    public int Stops;

    public bool Read(Reading reading) {
      int n = ++Readings;
      At(n);
      reading.Position_m[0] = 3e-4 * Math.Sin(n * 2e-3 * Math.PI);
      ++Done;
      return true;
    }

    public bool Command(double[] force_N) {
      lock (Commands_N) Commands_N.Add(force_N[0]);
      return true;
    }

    public void Stop() { Interlocked.Increment(ref Stops); }
  }

  static ClientSettings Settings(double duration_s = 0) =>
      new ClientSettings { Server = server, Scene = "wall", RemoteRendering = true, Once = true, Duration_s = duration_s };

  static Device DeviceOf(Pressed hand) {
    using (Facts facts = Facts.Parse(Wall, "pressed")) return Device.Of(facts, hand.Read, hand.Command, hand.Stop);
  }

  static void Until(Client client, Func<ClientState, bool> holds, string what) {
    const int patience_ms = 30000, each_ms = 5;
    var state = new ClientState();
    for (int waited = 0; waited < patience_ms; waited += each_ms) {
      client.Look(state);
      if (holds(state)) return;
      Thread.Sleep(each_ms);
    }
    throw new Failed(what + " within 30 s");
  }

  static void CallbacksFeelTheWall() {
    var hand = new Pressed();
    using (Device device = DeviceOf(hand))
    using (var client = new Client(Settings(), device)) {
      client.Start();
      // The device is the client's until its end.
      device.Dispose();
      GC.Collect();
      Until(client, state => state.Force_N[0] < 0 && state.Session == Session.Active, "a force out of the wall");
      Until(client, state => state.Simulated.Contains("wall"), "the scene's name");
      Expect(client.TryTake(out Event first) && first.Kind == EventKind.Welcomed, "a welcome, got " + first);
      Thrown<ForceboundException>(() => client.Summary());
      client.Stop();
      ExpectIn("\"verdict\"", client.Summary());
      Expect(hand.Stops > 0, "zero force at the end");
      Expect(device.CallbacksThrew == 0, "no exceptions");
    }
  }

  static void ExceptionsOfCallbacksEndInZeroForce() {
    const int first = 700, throws = 5;
    var hand = new Pressed();
    int before = 0, after = 0;
    hand.At = reading => {
      if (reading == first) before = hand.Commands_N.Count;
      if (reading == first + throws) after = hand.Commands_N.Count;
      if (reading >= first && reading < first + throws) throw new InvalidOperationException("number " + reading);
    };
    using (Device device = DeviceOf(hand))
    using (var client = new Client(Settings(), device)) {
      client.Start();
      Until(client, state => hand.Done > first + throws, "readings after the exceptions");
      Until(client, state => state.CallbacksFailed >= throws, "so many failures");
      for (int n = before; n < after; ++n) Expect(hand.Commands_N[n] == 0, "zero force without a reading");
      Expect(device.CallbacksThrew == throws, "5 exceptions, got " + device.CallbacksThrew);
      var told = Thrown<ForceboundException>(client.Stop, "threw 5 times", "InvalidOperationException: number 700");
      Expect(ReferenceEquals(told.InnerException, device.FirstThrown), "the first one within");
      Console.WriteLine(told.Message);
      client.Stop();
    }
  }

  // All of them, from the first call on: no session needs a device, and nothing ends the process.
  static void EveryCallbackMayThrow() {
    ReadDevice read = reading => { throw new Exception("read\nand a second line"); };
    CommandDevice command = force_N => { throw new Exception("command"); };
    Action stop = () => { throw new Exception("stop"); };
    using (Facts facts = Facts.Parse(Wall, "broken")) {
      using (Device device = Device.Of(facts, read, command, stop))
      using (var client = new Client(Settings(1), device)) {
        client.Start();
        Thrown<ForceboundException>(() => client.Wait());
        Expect(device.CallbacksThrew > 0, "exceptions counted");
      }
      Func<bool> start = () => { throw new Exception("start"); };
      using (Device device = Device.Of(facts, read, command, stop, start))
      using (var client = new Client(Settings(1), device)) {
        Action run = () => {
          client.Start();
          client.Wait();
        };
        Console.WriteLine(Thrown<ForceboundException>(run, "start").Message);
        Expect(device.FirstThrown.Message == "start", "its own exception");
      }
    }
  }

  static void ACallbackOf100msIsLate() {
    const int slow = 700, sleep_ms = 100;
    var hand = new Pressed();
    hand.At = reading => {
      if (reading == slow) Thread.Sleep(sleep_ms);
    };
    using (Device device = DeviceOf(hand))
    using (var client = new Client(Settings(), device)) {
      client.Start();
      Until(client, state => state.CallbacksLate > 0, "a late callback counted");
      Until(client, state => hand.Done > slow + 100, "readings afterwards");
      Expect(hand.Stops > 0, "zero force while it slept");
      client.Stop();
    }
  }

  static void TheProgramMayEndWithoutDispose() {
    var client = new Client(Settings(), DeviceOf(new Pressed()));
    client.Start();
    Until(client, state => state.Ticks > 100, "ticks");
  }

  static void Lose(Pressed hand) {
    var client = new Client(Settings(), DeviceOf(hand));
    client.Start();
    Until(client, state => state.Ticks > 100, "ticks");
  }

  static void AClientThatIsLostEnds() {
    const int patience = 200, each_ms = 50;
    var hand = new Pressed();
    var thread = new Thread(() => Lose(hand));
    thread.Start();
    thread.Join();
    for (int n = 0; n < patience && Volatile.Read(ref hand.Stops) == 0; ++n) {
      GC.Collect();
      Thread.Sleep(each_ms);
    }
    Expect(hand.Stops > 0, "zero force at its end");
  }

  static void SettingsAreRefusedWithOneLine() {
    using (Device device = Device.Open("wall-1dof")) {
      foreach (ClientSettings wrong in new[] { new ClientSettings(), new ClientSettings { Server = "nowhere" },
                                               new ClientSettings { Server = "127.0.0.1:1", Law = "fba-exakt" },
                                               new ClientSettings { Server = "127.0.0.1:1", Duration_s = -1 } }) {
        Console.WriteLine(Thrown<ForceboundException>(() => new Client(wrong, device)).Message);
      }
      using (var client = new Client(new ClientSettings { Server = "127.0.0.1:1" }, device)) {
        Console.WriteLine(Thrown<ForceboundException>(() => client.Wait(0)).Message);
      }
    }
    Console.WriteLine(Thrown<ForceboundException>(() => Device.Open("nothing-here")).Message);
  }

  static void LookingDoesNotAllocate() {
    const int looks = 200000;
    var hand = new Pressed();
    using (Device device = DeviceOf(hand))
    using (var client = new Client(Settings(), device)) {
      client.Start();
      Until(client, state => state.Session == Session.Active && state.Simulated.Length > 0, "a session");
      var seen = new ClientState();
      client.Look(seen);
      int collections = GC.CollectionCount(0);
      for (int n = 0; n < looks; ++n) client.Look(seen);
      collections = GC.CollectionCount(0) - collections;
      Console.WriteLine("{0} collections in {1} looks", collections, looks);
      Expect(collections == 0, "no collection");
      client.Stop();
    }
  }
}
