// Servers of the binding, with clients of the binding.
using System;
using System.Threading;
using Forcebound;
using Environment = Forcebound.Environment;

static partial class Checks {
  const double Stiffness_N_per_m = 123.4, Held_m = 0.001;

  static Environment SpringOf(Func<Answer, bool> also, Action<AnswerMotion> left = null) {
    Func<ClientFacts, AnswerMotion> create = facts => {
      Expect(facts.Axes == 1 && facts.Device == "pressed", "the client's facts, got " + facts.Device);
      return (motion, answer) => {
        answer.Force_N[0] = -Stiffness_N_per_m * motion.Position_m[0];
        answer.HasStiffness = true;
        answer.Stiffness_N_per_m[0] = Stiffness_N_per_m;
        answer.Radius_m = 0.01;
        return also(answer);
      };
    };
    return new Environment(create, left) { Name = "spring", Simulated = "a spring", Axes = 1 };
  }

  static Server Started(Environment environment) {
    var started = new Server(environment, new ServerSettings { Listen = "127.0.0.1:0" });
    started.Start();
    return started;
  }

  // What a client whose device is held at a place is asked for, once `holds`.
  static double RequestAt_N(Server at, Func<ClientState, bool> holds, double x_m = Held_m) {
    ReadDevice read = reading => {
      reading.Position_m[0] = x_m;
      return true;
    };
    var settings = new ClientSettings { Server = at.Look().Address, RemoteRendering = true, Once = true };
    using (Facts facts = Facts.Parse(Wall, "pressed"))
    using (Device device = Device.Of(facts, read, force_N => true))
    using (var client = new Client(settings, device)) {
      client.Start();
      Until(client, holds, "what is waited for");
      var state = new ClientState();
      client.Look(state);
      client.Stop();
      return state.Request_N[0];
    }
  }

  static void EnvironmentIsFelt() {
    int left = 0;
    using (Server spring = Started(SpringOf(answer => true, update => Interlocked.Increment(ref left)))) {
      GC.Collect();
      // A person's limits let it grow.
      RequestAt_N(spring, state => Math.Abs(state.Request_N[0] + Stiffness_N_per_m * Held_m) < 1e-12 &&
                                   state.Simulated == "a spring");
      spring.Stop();
      ServerState end = spring.Look();
      Expect(!end.IsRunning && end.Clients == 0 && end.Forces > 0 && end.CallbacksFailed == 0, "a server that ended");
      Expect(left == 1, "one client that left, got " + left);
      ExpectIn("\"environment\": \"spring\"", spring.Summary());
      ExpectIn("\"sessions_opened\": 1", spring.Summary());
    }
  }

  static void ExceptionsOfAnEnvironmentEndInZeroForce() {
    int fails = 1;
    Environment environment = SpringOf(answer => {
      if (Volatile.Read(ref fails) == 1) throw new InvalidOperationException("spring broke");
      return true;
    });
    using (Server broken = Started(environment)) {
      double request_N = RequestAt_N(broken, state => broken.Look().ForcesZero > 10);
      Expect(request_N == 0, "zero force, got " + request_N);
      Volatile.Write(ref fails, 0);
      Expect(RequestAt_N(broken, state => state.Request_N[0] != 0) < 0, "the spring's force again");
      Expect(broken.Look().CallbacksFailed == (ulong)environment.CallbacksThrew, "each exception counted");
      var told = Thrown<ForceboundException>(broken.Stop, "a callback of the environment threw",
                                             "InvalidOperationException: spring broke");
      Expect(ReferenceEquals(told.InnerException, environment.FirstThrown), "the first one within");
      Console.WriteLine(told.Message);
      broken.Stop();
    }
  }

  static void AnEnvironmentMayRefuseClients() {
    foreach (bool throws in new[] { false, true }) {
      Func<ClientFacts, AnswerMotion> create = facts => {
        if (throws) throw new Exception("create");
        return null;
      };
      using (Server closed = Started(new Environment(create))) {
        var settings = new ClientSettings { Server = closed.Look().Address, Once = true };
        using (Device device = Device.Open("wall-1dof"))
        using (var client = new Client(settings, device)) {
          client.Start();
          Thrown<ForceboundException>(() => client.Wait(), "refused");
          Expect(client.TryTake(out Event refused) && refused.Kind == EventKind.Refused, "a refusal, got " + refused);
          ExpectIn("its callback 'create' failed", refused.Text);
        }
        if (throws) Thrown<ForceboundException>(closed.Stop, "threw", "Exception: create");
      }
    }
  }

  static void ServersAreRefusedWithOneLine() {
    Environment spring = SpringOf(answer => true);
    Thrown<ArgumentNullException>(() => new Server((Environment)null));
    Thrown<ArgumentNullException>(() => new Environment(null));
    using (Server first = Started(spring)) {
      foreach (ServerSettings wrong in new[] { new ServerSettings { Listen = "nowhere" },
                                               new ServerSettings { Listen = first.Look().Address },
                                               new ServerSettings { Listen = "0.0.0.0:0" },
                                               new ServerSettings { Listen = "127.0.0.1:0", ClientsMax = -1 } }) {
        Console.WriteLine(Thrown<ForceboundException>(() => new Server(spring, wrong)).Message);
      }
      Thrown<ForceboundException>(first.Start, "a server runs once");
      first.Dispose();
      Thrown<ObjectDisposedException>(() => first.Look());
    }
  }

  // A floor, which is reported once a step; the device is held below it.
  static void SimulatorIsFeltBetweenItsSteps() {
    const string threeAxes =
        "kind = \"cartesian\"\ndegrees_of_freedom = 3\ndamping_N_s_per_m = 5\nforce_N_max = 20\nhold_s_max = 0.005\n";
    ReadDevice read = reading => {
      reading.Position_m[2] = -Held_m;
      return true;
    };
    using (var floor = new Server(new Simulator { Name = "floor" }, new ServerSettings { Listen = "127.0.0.1:0" })) {
      floor.Start();
      var settings = new ClientSettings { Server = floor.Look().Address, Once = true };
      double pushed_N = 0;
      using (Facts facts = Facts.Parse(threeAxes, "held"))
      using (Device device = Device.Of(facts, read, force_N => true))
      using (var client = new Client(settings, device)) {
        client.Start();
        Until(client, state => {
          foreach (Probe probe in floor.Ask()) {
            double pushed_Ns = 0;  // under the newest report, and under the one before
            foreach (Push push in probe.Pushes) pushed_Ns += push.Body == 7 ? push.Impulse_Ns[2] : 0;
            pushed_N = probe.Interval_s > 0 ? pushed_Ns / probe.Interval_s : 0;
            Expect(floor.Report(probe.Client, new Touch { Body = 7, Place_m = new double[3],
                                                          Normal = new double[] { 0, 0, 1 } }), "a report");
          }
          return state.Request_N[2] > 1.9 && pushed_N < -1.9;
        }, "2 N of the floor");
        Thrown<ArgumentException>(() => floor.Report(1, new Touch { Place_m = new double[2] }));
        Console.WriteLine(Thrown<ForceboundException>(
            () => floor.Report(1, new Touch { Place_m = new double[3], Normal = new double[3] })).Message);
        Expect(!floor.Report(99), "a client that is not there");
        client.Stop();
      }
      ServerState end = floor.Look();
      Expect(end.Reports > 0 && end.ReportsRefused == 2, "two refused, got " + end.ReportsRefused);
    }
  }

  static void TheProgramMayEndWithItsServer() {
    Server spring = Started(SpringOf(answer => true));
    Expect(RequestAt_N(spring, state => state.Request_N[0] != 0) < 0, "the spring's force");
  }
}
