// Facts and laws, which need no server.
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.Threading;
using Forcebound;

static partial class Checks {
  static void LibraryIsMissing() {
    Console.WriteLine(Thrown<DllNotFoundException>(() => Facts.Load("omni"), "libforcebound.so").Message);
    Console.WriteLine(Thrown<DllNotFoundException>(() => Device.Open("omni"), "libforcebound.so").Message);
    Console.WriteLine(Thrown<DllNotFoundException>(() => { var names = Law.Names; }, "libforcebound.so").Message);
  }

  static void FactsAreThoseOfTheFile() {
    using (Facts facts = Facts.Load("wall-1dof")) {
      Expect(facts.Name == "wall-1dof" && facts.Axes == 1 && facts.Joints == 1 && facts.IsCartesian, "wall-1dof");
      Expect(facts.ForceMax_N == 30 && facts.Period_s == 1e-3, "force 30 N, period 1 ms");
    }
    using (Facts facts = Facts.Load("omni")) Expect(facts.Axes == 3 && !facts.IsCartesian, "omni has three joints");
    Thrown<ForceboundException>(() => Facts.Load("omnii"), "omnii");
    Thrown<ForceboundException>(() => Facts.Parse("kind = 3", "mine"), "mine");
    Thrown<ArgumentException>(() => Facts.Load("om\0ni"), "nameOrPath has a zero character at 2");
    Thrown<ArgumentNullException>(() => Facts.Parse(null, "mine"), "toml is null");
  }

  static Law Exact(Facts facts) => new Law("fba-exact", facts);

  static void LawIsTheLibrarys() {
    Expect(new List<string>(Law.Names).Contains("fba-exact"), "fba-exact among the laws");
    using (Facts facts = Facts.Load("wall-1dof")) {
      Thrown<ForceboundException>(() => new Law("fba-exakt", facts), "fba-exakt");
      Thrown<ForceboundException>(() => new Law("vc", facts, "[vc]\nstiff = 3\n"), "stiff");
      using (Law law = Exact(facts)) {
        var motion = new Motion(facts);
        var force_N = new double[1];
        law.Tick(motion, new[] { -10.0 }, force_N);
        Expect(force_N[0] == 0, "nothing may be spent before a motion");
        motion.Interval_s = 1e-3;
        motion.Position[0] = 1e-3;
        law.Tick(motion, new[] { -10.0 }, force_N);
        Expect(force_N[0] < 0 && force_N[0] >= -10, "a force within the request");
        Expect(law.Ledger().Energy_J >= 0 && !law.Ledger().IsAudited, "an account, without P");
        law.Confirm(-1e-3, force_N);
        Expect(force_N[0] == 0 && law.Ledger().ForcesWithdrawn == 1, "a force in effect before its reading is withdrawn");
        motion.Position[0] = double.NaN;
        law.Tick(motion, null, force_N);
        Expect(law.Ledger().ReadingsNotFinite == 1, "a reading that is not finite is counted");
      }
    }
  }

  static void WrongLengthsAreRefused() {
    using (Facts facts = Facts.Load("omni"))
    using (Facts other = Facts.Load("wall-1dof"))
    using (Law law = Exact(facts)) {
      var motion = new Motion(facts);
      double[] three = { 1, 2, 3 };
      Thrown<ArgumentException>(() => law.Tick(motion, new double[2], three), "request_N has 2 numbers, expected 3");
      Expect(three[0] == 0 && three[1] == 0 && three[2] == 0, "zero force after an error");
      Thrown<ArgumentException>(() => law.Tick(motion, null, new double[4]), "force_N has 4 numbers, expected 3");
      Thrown<ArgumentException>(() => law.Tick(motion, null, null), "force_N is null, expected 3");
      Thrown<ArgumentException>(() => law.Tick(null, null, three), "motion is null");
      Thrown<ArgumentException>(() => law.Tick(new Motion(other), null, three),
                                "motion.Position has 1 numbers, expected 3");
      Expect(law.Ledger().CallsRefused == 5, "each is a lost reading for the law");
      Thrown<ArgumentException>(() => law.Confirm(0, new double[1]), "force_N has 1 numbers, expected 3");
    }
  }

  static void UseAfterDisposeIsRefused() {
    Facts facts = Facts.Load("wall-1dof");
    Law law = Exact(facts);
    var motion = new Motion(facts);
    facts.Dispose();
    facts.Dispose();
    Thrown<ObjectDisposedException>(() => Exact(facts), "Forcebound.Facts");
    Thrown<ObjectDisposedException>(() => Device.Of(facts, reading => true, force_N => true), "Forcebound.Facts");
    law.Tick(motion, null, new double[1]);
    law.Dispose();
    Thrown<ObjectDisposedException>(() => law.Tick(motion, null, new double[1]), "Forcebound.Law");
    Thrown<ObjectDisposedException>(() => law.Ledger(), "Forcebound.Law");
    Device device = Device.Open("wall-1dof");
    device.Dispose();
    Thrown<ObjectDisposedException>(() => new Client(new ClientSettings { Server = "127.0.0.1:1" }, device),
                                    "Forcebound.Device");
    using (Device again = Device.Open("wall-1dof")) {
      var client = new Client(new ClientSettings { Server = "127.0.0.1:1" }, again);
      client.Dispose();
      client.Dispose();
      Thrown<ObjectDisposedException>(client.Start, "Forcebound.Client");
      Thrown<ObjectDisposedException>(() => client.Look(new ClientState()), "Forcebound.Client");
    }
  }

  // While one thread ticks another disposes: the law lives until the call is over, and none is corrupted.
  static void DisposeWaitsForTheTick() {
    using (Facts facts = Facts.Load("wall-1dof")) {
      for (int round = 0; round < 200; ++round) {
        Law law = Exact(facts);
        var started = new ManualResetEventSlim();
        Exception ended = null;
        var thread = new Thread(() => {
          var motion = new Motion(facts);
          var force_N = new double[1];
          try {
            for (;;) {
              law.Tick(motion, null, force_N);
              started.Set();
            }
          } catch (Exception e) {
            ended = e;
          }
        });
        thread.Start();
        started.Wait();
        law.Dispose();
        thread.Join();
        Expect(ended is ObjectDisposedException, "ObjectDisposedException, got " + ended);
      }
    }
  }

  static void LeaderIsTheLibrarys() {
    var servo = new LeaderJoint { Name = "elbow",
                                  Damping_N_m_s_per_rad = 0.15,
                                  Friction_N_m = 0.03,
                                  EncoderStep_rad = 2 * Math.PI / 4096,
                                  MaxTorque_N_m = 1,
                                  MaxSpeed_rad_per_s = 30,
                                  GoalStiffness_N_m_per_rad = 0.5 };
    var settings = new LeaderSettings { Period_s = 0.005, MaxLatency_s = 0.001 };
    using (var leader = new ForceBoundedLeader(new[] { servo, servo }, settings)) {
      double[] position_rad = new double[2], feedback_N_m = { -1, -1 }, torque_N_m = new double[2],
               goal_rad = new double[2];
      for (int n = 0; n < 200; ++n) {
        position_rad[0] = position_rad[1] = 0.005 * n;
        leader.Step(position_rad, feedback_N_m, 0.005, torque_N_m);
      }
      leader.Goals(goal_rad);
      Expect(torque_N_m[0] < 0 && torque_N_m[0] == torque_N_m[1], "a torque, got " + torque_N_m[0]);
      Expect(Math.Abs(goal_rad[0] - position_rad[0] - torque_N_m[0] / 0.5) < 1e-12, "its goal, got " + goal_rad[0]);
      Thrown<ArgumentException>(() => leader.Step(new double[3], feedback_N_m, 0.005, torque_N_m), "2");
      Expect(torque_N_m[0] == 0, "zero torque after a wrong call");
      leader.ReportFailedWrite();
      LeaderState state = leader.State();
      Expect(state.ReadingsLost == 2 && state.WritesFailed == 1 && state.Late == 0, "what was lost is counted");
    }
    servo.MaxTorque_N_m = 0;
    Thrown<ForceboundException>(() => new ForceBoundedLeader(new[] { servo }),
                                "joint 'elbow': torque_N_m_max must be > 0");
    Thrown<ForceboundException>(() => new ForceBoundedLeader(new LeaderJoint[0]), "count must be 1 to 1000");
  }

  // Any allocation would fill the nursery, of 4 MB, and have it collected: the smallest object has 16 bytes.
  static void TickDoesNotAllocate() {
    const int warm = 1000, ticks = 400000;
    using (Facts facts = Facts.Load("omni"))
    using (Law law = Exact(facts)) {
      var motion = new Motion(facts) { Interval_s = 1e-3, Latency_s = 1e-4 };
      double[] request_N = { 1, 2, 3 }, force_N = new double[3];
      motion.Jacobian[0] = motion.Jacobian[4] = motion.Jacobian[8] = 0.1;
      ulong saturated = 0;
      Action<int> run = count => {
        for (int n = 0; n < count; ++n) {
          motion.Position[0] = 1e-6 * (n % 100);
          motion.Joint[0] = 1e-5 * (n % 100);
          law.Tick(motion, request_N, force_N);
          law.Confirm(1e-4, force_N);
          saturated += law.Ledger().Saturated;
        }
      };
      run(warm);
      int collections = GC.CollectionCount(0);
      Stopwatch watch = Stopwatch.StartNew();
      run(ticks);
      double each_us = watch.Elapsed.TotalMilliseconds * 1000 / ticks;
      collections = GC.CollectionCount(0) - collections;
      Console.WriteLine("{0} collections in {1} ticks of {2:F2} us each", collections, ticks, each_us);
      Expect(collections == 0, "no collection");
    }
  }
}
