// libforcebound (client/library/forcebound.h) in C# 7.3, one file; compile it with -unsafe. Units, frames and threads are
// those of the header: SI, x to the user's right, y away from the user, z up, a force is what the device does to the hand.
//
// Errors: ForceboundException with the library's one line; ArgumentException for arrays of a wrong length, with the right
// one; ObjectDisposedException after Dispose; DllNotFoundException where there is no library for this machine.
//
// Real time: "tick" marks methods that allocate nothing. The runtime may still stop their thread to collect garbage that
// others made; a client's own tick is in the library and is not stopped, unless its device has callbacks in C#.
using System;
using System.Collections.Generic;
using System.IO;
using System.Runtime.InteropServices;
using System.Text;
using System.Threading;

namespace Forcebound {

/// <summary>What a function of the library returned.</summary>
public enum Status {
  Ok = Native.FB_OK,
  Invalid = Native.FB_INVALID,
  Failed = Native.FB_FAILED,
  NotNow = Native.FB_NOT_NOW,
  Nothing = Native.FB_NOTHING,
  TooSmall = Native.FB_TOO_SMALL,
  NoMemory = Native.FB_NO_MEMORY
}

/// <summary>The library refused or failed; the message says what, where, and what would be accepted. An exception that a
/// callback threw is the inner one.</summary>
public sealed class ForceboundException : Exception {
  public ForceboundException(Status status, string message, Exception inner = null) : base(message, inner) {
    Status = status;
  }

  public Status Status { get; }
}

/// <summary>The library itself.</summary>
public static class Library {
  private static volatile bool found;

  /// <summary>"0.2.0", of the library that runs.</summary>
  public static string Version {
    get {
      Require();
      return Native.Text(Native.fb_version());
    }
  }

  /// <exception cref="DllNotFoundException">There is none for this machine, or it is too old.</exception>
  internal static void Require() {
    if (found) return;
    try {
      Native.fb_version();
    } catch (DllNotFoundException e) {
      throw new DllNotFoundException(WhyNot(), e);
    } catch (BadImageFormatException e) {
      throw new DllNotFoundException(WhyNot(), e);
    } catch (EntryPointNotFoundException e) {
      throw new DllNotFoundException("the libforcebound.so that was found is another library: it has no fb_version", e);
    }
    found = true;
  }

  /// <summary>Where the library lies, and for another processor: says so.</summary>
  private static string WhyNot() {
    const string file = "libforcebound.so";
    var folders = new List<string>();
    folders.AddRange((System.Environment.GetEnvironmentVariable("LD_LIBRARY_PATH") ?? "").Split(':'));
    folders.Add(AppDomain.CurrentDomain.BaseDirectory);
    foreach (string folder in folders) {
      if (folder.Length == 0) continue;
      string path = Path.Combine(folder, file);
      if (!File.Exists(path)) continue;
      string built = BuiltFor(path), wanted = ForThisProcess();
      return built == wanted
                 ? path + " is there, but cannot be loaded: a library that it needs is missing; see: ldd " + path
                 : path + " is " + built + ", expected an ELF library " + wanted;
    }
    return file + " not found, expected in a folder of LD_LIBRARY_PATH, beside the program, where the system keeps " +
           "libraries, or in Unity in Plugins/x86_64";
  }

  private static string ForThisProcess() {
    switch (RuntimeInformation.ProcessArchitecture) {
      case Architecture.X86: return "for x86";
      case Architecture.Arm: return "for ARM";
      case Architecture.Arm64: return "for AArch64";
      default: return "for x86-64";
    }
  }

  private static string BuiltFor(string path) {
    const int machineAt = 18;
    var head = new byte[machineAt + 2];
    try {
      using (FileStream stream = File.OpenRead(path)) {
        if (stream.Read(head, 0, head.Length) < head.Length || head[0] != 0x7f || head[1] != 'E' || head[2] != 'L' ||
            head[3] != 'F') {
          return "no ELF library";
        }
      }
    } catch (Exception e) when (e is IOException || e is UnauthorizedAccessException) {
      return "not readable";
    }
    switch (head[machineAt] | (head[machineAt + 1] << 8)) {
      case 3: return "for x86";
      case 40: return "for ARM";
      case 62: return "for x86-64";
      case 183: return "for AArch64";
      default: return "for another processor";
    }
  }
}

/// <summary>What is known of a haptic device, and all that a law relies on. Constant; any thread.</summary>
public sealed class Facts : IDisposable {
  private readonly Native.FactsHandle handle;

  /// <summary>Of a device that ships ("omni"), or of a TOML file by its path.</summary>
  public static Facts Load(string nameOrPath) {
    Library.Require();
    IntPtr made;
    Native.Check(Native.fb_facts_load(Native.Utf8(nameOrPath, nameof(nameOrPath)), out made));
    return new Facts(made);
  }

  /// <summary>Of TOML text. <paramref name="name"/> is the device's, for errors.</summary>
  public static Facts Parse(string toml, string name) {
    Library.Require();
    IntPtr made;
    Native.Check(Native.fb_facts_parse(Native.Utf8(toml, nameof(toml)), Native.Utf8(name, nameof(name)), out made));
    return new Facts(made);
  }

  private unsafe Facts(IntPtr made) {
    handle = new Native.FactsHandle(made);
    var info = new Native.fb_facts_info { size = (UIntPtr)sizeof(Native.fb_facts_info) };
    Native.Check(Native.fb_facts_describe(handle, &info));
    Name = Native.Text((IntPtr)info.name);
    Axes = info.axes;
    Rotations = info.rotations;
    Joints = info.joints;
    IsCartesian = info.cartesian != 0;
    IsIdentified = info.identified != 0;
    Period_s = info.period_s;
    ForceMax_N = info.force_N_max;
    TorqueMax_N_m = info.torque_N_m_max;
    Latency_s = info.latency_s;
    HoldMax_s = info.hold_s_max;
  }

  public string Name { get; }
  /// <summary>Of positions and forces; the last three are rotations and torques where Rotations is 3.</summary>
  public int Axes { get; }
  public int Rotations { get; }
  public int Joints { get; }
  /// <summary>Motions need neither joints nor a Jacobian.</summary>
  public bool IsCartesian { get; }
  /// <summary>If not, the bounds are guesses, and nothing is called passive.</summary>
  public bool IsIdentified { get; }
  public double Period_s { get; }
  public double ForceMax_N { get; }
  public double TorqueMax_N_m { get; }
  public double Latency_s { get; }
  /// <summary>The device holds a force for so long without a new one; 0: it never releases.</summary>
  public double HoldMax_s { get; }

  internal Native.FactsHandle Handle => Native.Open(handle, nameof(Facts));

  /// <summary>What was made with them goes on.</summary>
  public void Dispose() => handle.Dispose();
}

/// <summary>What a tick measured; made once, then filled at each tick. See fb_motion.</summary>
public sealed class Motion {
  public Motion(Facts facts) {
    Position = new double[facts.Axes];
    Joint = new double[facts.IsCartesian ? 0 : facts.Joints];
    Jacobian = new double[facts.IsCartesian ? 0 : facts.Axes * facts.Joints];
  }

  /// <summary>Between the reading before and this one, measured; 0 at the first.</summary>
  public double Interval_s;
  /// <summary>Of the tip [m], below it the rotations [rad]. Not finite: the reading is lost.</summary>
  public readonly double[] Position;
  /// <summary>Encoders [m], [rad]; empty for a Cartesian device.</summary>
  public readonly double[] Joint;
  /// <summary>d position / d joint, row by row; empty for a Cartesian device.</summary>
  public readonly double[] Jacobian;
  /// <summary>Whether the last force was ever in effect is unknown.</summary>
  public bool WriteFailed;
  /// <summary>From the reading before to the effect of the force chosen on it; null: by the facts, as all below.</summary>
  public double? Latency_s;
  public double? LatencyMax_s;
  /// <summary>As Latency_s, but reported by the device.</summary>
  public double? Effect_s;
  /// <summary>From that effect until the device let go of the force.</summary>
  public double? Held_s;

  internal unsafe void Write(Native.fb_motion* to) {
    to->size = (UIntPtr)sizeof(Native.fb_motion);
    to->has = 0;
    to->write_failed = WriteFailed ? 1 : 0;
    to->interval_s = Interval_s;
    for (int k = 0; k < Position.Length; ++k) to->position[k] = Position[k];
    for (int k = 0; k < Joint.Length; ++k) to->joint[k] = Joint[k];
    for (int k = 0; k < Jacobian.Length; ++k) to->jacobian[k] = Jacobian[k];
    to->latency_s = Optional(Latency_s, Native.FB_HAS_LATENCY, ref to->has);
    to->latency_s_max = Optional(LatencyMax_s, Native.FB_HAS_LATENCY_MAX, ref to->has);
    to->effect_s = Optional(Effect_s, Native.FB_HAS_EFFECT, ref to->has);
    to->held_s = Optional(Held_s, Native.FB_HAS_HELD, ref to->has);
  }

  private static double Optional(double? value, uint bit, ref uint has) {
    if (value.HasValue) has |= bit;
    return value.GetValueOrDefault();
  }
}

/// <summary>The account of a law, and what it counted. See fb_ledger.</summary>
public struct Ledger {
  internal Native.fb_ledger native;

  /// <summary>That the law may spend now.</summary>
  public double Energy_J => native.energy_J;
  public double ShareCredited => native.share_credited;
  /// <summary>The device is simulated, and P is known.</summary>
  public bool IsAudited => native.audited != 0;
  /// <summary>What the device dissipated less what its motors returned, now,</summary>
  public double P_J => native.P_J;
  /// <summary>and the least that it ever was: below zero, not passive.</summary>
  public double LeastP_J => native.P_J_least;
  public ulong RequestsNotFinite => native.requests_not_finite;
  public ulong ReadingsNotFinite => native.readings_not_finite;
  public ulong ReadingsTooFar => native.readings_too_far;
  public ulong WritesFailed => native.writes_failed;
  public ulong EffectsOutsideFacts => native.effects_outside_facts;
  public ulong ReleasesOutsideFacts => native.releases_outside_facts;
  public ulong IntervalsImpossible => native.intervals_impossible;
  public ulong Saturated => native.saturated;
  public ulong ForcesNotFinite => native.forces_not_finite;
  public ulong ForcesWithdrawn => native.forces_withdrawn;
  public ulong CallsRefused => native.calls_refused;
}

/// <summary>Bounds each force so that the device returns no more energy than its own damping took. One thread at a time;
/// a second one gets an error, not a corrupt account.</summary>
public sealed class Law : IDisposable {
  private readonly Native.LawHandle handle;
  private readonly int axes;
  private readonly int joints;
  private int entered;

  /// <summary>Of the laws that ship.</summary>
  public static IReadOnlyList<string> Names {
    get {
      Library.Require();
      var names = new List<string>();
      for (int n = 0;; ++n) {
        IntPtr name = Native.fb_law_name((UIntPtr)n);
        if (name == IntPtr.Zero) return names;
        names.Add(Native.Text(name));
      }
    }
  }

  /// <param name="name">"fba-exact", "fba-less", ..., of Names.</param>
  /// <param name="parameters">TOML with a table for each law; null: standard values.</param>
  /// <param name="fullMemory">fba-less and fba-exact keep all energy for later.</param>
  public unsafe Law(string name, Facts facts, string parameters = null, bool fullMemory = false) {
    Native.Given(facts, nameof(facts));
    axes = facts.Axes;
    joints = facts.IsCartesian ? 0 : facts.Joints;
    using (var texts = new Native.Texts()) {
      var options = new Native.fb_law_options {
        size = (UIntPtr)sizeof(Native.fb_law_options),
        parameters = texts.Add(parameters, nameof(parameters)),
        full_memory = fullMemory ? 1 : 0
      };
      IntPtr made;
      Native.Check(Native.fb_law_create(Native.Utf8(name, nameof(name)), facts.Handle, &options, out made));
      handle = new Native.LawHandle(made);
    }
  }

  /// <summary>Notes the motion and gives the force for the device, which the law then takes for commanded. After any
  /// error the force is zero. Tick.</summary>
  /// <param name="request_N">What the environment asks for; null: nothing, or what it asked for is too old.</param>
  public unsafe void Tick(Motion motion, double[] request_N, double[] force_N) {
    Enter();
    try {
      Check(motion, request_N, force_N);
      Native.fb_motion native;
      motion.Write(&native);
      fixed (double* request = request_N)
      fixed (double* force = force_N) {
        Native.Check(Native.fb_law_tick(handle, &native, request, force, (UIntPtr)axes));
      }
    } finally {
      Leave();
    }
  }

  // A tick that is refused here is lost for the law too, so that a force is never charged too little.
  private unsafe void Check(Motion motion, double[] request_N, double[] force_N) {
    try {
      Native.Length(force_N, axes, nameof(force_N));
      Array.Clear(force_N, 0, axes);
      if (request_N != null) Native.Length(request_N, axes, nameof(request_N));
      Native.Given(motion, nameof(motion));
      Native.Length(motion.Position, axes, "motion.Position");
      Native.Length(motion.Joint, joints, "motion.Joint");
      Native.Length(motion.Jacobian, axes * joints, "motion.Jacobian");
    } catch (ArgumentException) {
      Native.fb_law_tick(handle, null, null, null, UIntPtr.Zero);
      throw;
    }
  }

  /// <summary>The force that the last tick gave, or zero if it takes effect too late after the reading. Tick.</summary>
  public unsafe void Confirm(double latency_s, double[] force_N) {
    Enter();
    try {
      Native.Length(force_N, axes, nameof(force_N));
      Array.Clear(force_N, 0, axes);
      fixed (double* force = force_N) {
        Native.Check(Native.fb_law_confirm(handle, latency_s, force, (UIntPtr)axes));
      }
    } finally {
      Leave();
    }
  }

  /// <summary>Tick.</summary>
  public unsafe Ledger Ledger() {
    Enter();
    try {
      var ledger = new Ledger();
      ledger.native.size = (UIntPtr)sizeof(Native.fb_ledger);
      Native.Check(Native.fb_law_ledger(handle, &ledger.native));
      return ledger;
    } finally {
      Leave();
    }
  }

  private void Enter() {
    if (Interlocked.CompareExchange(ref entered, 1, 0) != 0) {
      throw new InvalidOperationException("Law: another thread is in a call of it, accepted is one thread at a time");
    }
    if (handle.IsClosed) {
      Leave();
      Native.Open(handle, nameof(Law));
    }
  }

  private void Leave() => Volatile.Write(ref entered, 0);

  public void Dispose() => handle.Dispose();
}

/// <summary>A joint of a leader arm and its servo: bounds, of which the truth is never worse. See
/// fb_leader_joint.</summary>
public sealed class LeaderJoint {
  public string Name;
  public double Damping_N_m_s_per_rad;
  public double Friction_N_m;
  public double EncoderStep_rad;
  public double Backlash_rad;
  public double MaxTorque_N_m;
  public double TorqueStep_N_m;
  public double TorqueGainShare;
  public double TorqueRippleShare;
  /// <summary>Never exceeded; 0: not known.</summary>
  public double MaxSpeed_rad_per_s;
  /// <summary>0: it takes torques; else goals.</summary>
  public double GoalStiffness_N_m_per_rad;
  /// <summary>Of goals; both 0: any.</summary>
  public double LeastGoal_rad;
  public double MostGoal_rad;
}

/// <summary>The loop of a leader arm; 0 is the standard value. See fb_leader_settings.</summary>
public sealed class LeaderSettings {
  public double Period_s;
  public double MaxLatency_s;
  public double MaxRead_s;
  public double MaxHold_s;
  public double LeastWatchdog_s;
  public double ClockShare;
  public double Memory_J;
}

/// <summary>What a leader may spend, and what it counted. See fb_leader_state.</summary>
public struct LeaderState {
  internal Native.fb_leader_state native;

  public double LeastEnergy_J => native.energy_J_least;
  public ulong ReadingsLost => native.readings_lost;
  public ulong FeedbackNotFinite => native.feedback_not_finite;
  public ulong Saturated => native.saturated;
  public ulong IntervalsImpossible => native.intervals_impossible;
  public ulong Late => native.late;
  public ulong WritesFailed => native.writes_failed;
}

/// <summary>Bounds the torques of a leader arm so that its joints return no more energy than they dissipate. One
/// thread at a time.</summary>
public sealed class ForceBoundedLeader : IDisposable {
  private readonly Native.LeaderHandle handle;
  private readonly int joints;

  /// <param name="settings">Null: standard values, and no latency.</param>
  public unsafe ForceBoundedLeader(LeaderJoint[] servos, LeaderSettings settings = null) {
    Native.Given(servos, nameof(servos));
    Library.Require();
    joints = servos.Length;
    LeaderSettings loop = settings ?? new LeaderSettings();
    using (var texts = new Native.Texts()) {
      var all = new Native.fb_leader_joint[Math.Max(1, joints)];
      for (int k = 0; k < joints; ++k) {
        Native.Given(servos[k], nameof(servos));
        all[k] = new Native.fb_leader_joint { size = (UIntPtr)sizeof(Native.fb_leader_joint),
                                              name = texts.Add(servos[k].Name, nameof(LeaderJoint.Name)),
                                              damping_N_m_s_per_rad = servos[k].Damping_N_m_s_per_rad,
                                              friction_N_m = servos[k].Friction_N_m,
                                              encoder_step_rad = servos[k].EncoderStep_rad,
                                              backlash_rad = servos[k].Backlash_rad,
                                              torque_N_m_max = servos[k].MaxTorque_N_m,
                                              torque_step_N_m = servos[k].TorqueStep_N_m,
                                              torque_gain_share = servos[k].TorqueGainShare,
                                              torque_ripple_share = servos[k].TorqueRippleShare,
                                              speed_rad_per_s_max = servos[k].MaxSpeed_rad_per_s,
                                              goal_stiffness_N_m_per_rad = servos[k].GoalStiffness_N_m_per_rad,
                                              goal_rad_least = servos[k].LeastGoal_rad,
                                              goal_rad_most = servos[k].MostGoal_rad };
      }
      var native = new Native.fb_leader_settings { size = (UIntPtr)sizeof(Native.fb_leader_settings),
                                                   period_s = loop.Period_s,
                                                   latency_s_max = loop.MaxLatency_s,
                                                   read_s_max = loop.MaxRead_s,
                                                   hold_s_max = loop.MaxHold_s,
                                                   watchdog_s_least = loop.LeastWatchdog_s,
                                                   clock_share = loop.ClockShare,
                                                   memory_J = loop.Memory_J };
      IntPtr made;
      fixed (Native.fb_leader_joint* first = all) {
        Native.Check(Native.fb_leader_create(first, (UIntPtr)joints, &native, out made));
      }
      handle = new Native.LeaderHandle(made);
    }
  }

  /// <summary>Notes the readings and gives the torques to command now. Tick.</summary>
  /// <param name="feedback_N_m">Null: there is none, or it is too old.</param>
  /// <param name="interval_s">Since the stamp of the step before, measured.</param>
  public unsafe void Step(double[] position_rad, double[] feedback_N_m, double interval_s, double[] torque_N_m) {
    try {
      Native.Length(torque_N_m, joints, nameof(torque_N_m));
      Array.Clear(torque_N_m, 0, joints);
      Native.Length(position_rad, joints, nameof(position_rad));
      if (feedback_N_m != null) Native.Length(feedback_N_m, joints, nameof(feedback_N_m));
    } catch (ArgumentException) {
      Native.fb_leader_step(handle, null, null, interval_s, null, UIntPtr.Zero);  // lost
      throw;
    }
    fixed (double* position = position_rad)
    fixed (double* feedback = feedback_N_m)
    fixed (double* torque = torque_N_m) {
      Native.Check(Native.fb_leader_step(handle, position, feedback, interval_s, torque, (UIntPtr)joints));
    }
  }

  /// <summary>The torques of the last step may not have been written, or not in time. Tick.</summary>
  public void ReportFailedWrite() => Native.Check(Native.fb_leader_write_failed(handle));

  /// <summary>What to write to servos that take goals; not a number for others. Tick.</summary>
  public unsafe void Goals(double[] goal_rad) {
    Native.Length(goal_rad, joints, nameof(goal_rad));
    fixed (double* goal = goal_rad) Native.Check(Native.fb_leader_goals(handle, goal, (UIntPtr)joints));
  }

  /// <summary>Tick.</summary>
  public unsafe LeaderState State() {
    var state = new LeaderState();
    state.native.size = (UIntPtr)sizeof(Native.fb_leader_state);
    Native.Check(Native.fb_leader_look(handle, &state.native));
    return state;
  }

  public void Dispose() => handle.Dispose();
}

/// <summary>One reading of a device with callbacks. All of it is as fb_reading says.</summary>
public sealed class Reading {
  internal Reading(Facts facts) {
    Position_m = new double[facts.Axes - facts.Rotations];
    Joint = new double[facts.IsCartesian ? 0 : facts.Joints];
    Jacobian = new double[facts.IsCartesian ? 0 : facts.Axes * facts.Joints];
  }

  /// <summary>CLOCK_MONOTONIC; now, unless the device knows it better.</summary>
  public long Latched_ns;
  public readonly double[] Position_m;
  public readonly double[] Joint;
  public readonly double[] Jacobian;
  /// <summary>Bit k: button k is pressed; null: it has none.</summary>
  public uint? Buttons;
  /// <summary>0: closed, 1: open; null: it has none.</summary>
  public double? Gripper;
  /// <summary>Whether Orientation, a unit quaternion w, x, y, z, is set.</summary>
  public bool HasOrientation;
  public readonly double[] Orientation = { 1, 0, 0, 0 };

  internal unsafe void Write(Native.fb_reading* to) {
    uint has = 0;
    if (Buttons.HasValue) has |= Native.FB_HAS_BUTTONS;
    if (Gripper.HasValue) has |= Native.FB_HAS_GRIPPER;
    if (HasOrientation) has |= Native.FB_HAS_ORIENTATION;
    to->has = has;
    to->buttons = Buttons.GetValueOrDefault();
    to->latched_ns = Latched_ns;
    for (int k = 0; k < Position_m.Length; ++k) to->position_m[k] = Position_m[k];
    for (int k = 0; k < Joint.Length; ++k) to->joint[k] = Joint[k];
    for (int k = 0; k < Jacobian.Length; ++k) to->jacobian[k] = Jacobian[k];
    for (int k = 0; k < Orientation.Length; ++k) to->orientation[k] = Orientation[k];
    to->gripper = Gripper.GetValueOrDefault();
  }
}

/// <summary>Reads the device; false: not done. Called 1000 times a second: to return within 0.2 ms, without waiting or
/// allocating. One that takes more than 10 ms, or throws, has failed: no force until there is a reading again.</summary>
public delegate bool ReadDevice(Reading reading);
/// <summary>Commands a force [N] and torque, until the next one; false: not done. Likewise. The array is used again.
/// </summary>
public delegate bool CommandDevice(double[] force_N);

/// <summary>One of ours, or callbacks of yours.</summary>
public sealed class Device : IDisposable {
  private readonly Native.DeviceHandle handle;

  /// <param name="device">Simulated ("omni", or a TOML file by its path), or behind a driver ("evdev:path=...").</param>
  /// <param name="hand">That moves a simulated device; null: its default.</param>
  public static Device Open(string device, string hand = null) {
    Library.Require();
    IntPtr made;
    Native.Check(Native.fb_device_open(Native.Utf8(device, nameof(device)),
                                       hand == null ? null : Native.Utf8(hand, nameof(hand)), out made));
    return new Device(new Native.DeviceHandle(made, default(GCHandle)), null);
  }

  /// <summary>Callbacks. An exception of theirs ends in here: zero force, counted, and reported by the client's Wait and
  /// Stop.</summary>
  /// <param name="stop">Zero force at once, on any thread, also while another callback is in progress; null: `command`
  /// of zeros.</param>
  /// <param name="start">Ready to read; false: not. Null: it always is.</param>
  public static unsafe Device Of(Facts facts, ReadDevice read, CommandDevice command, Action stop = null,
                                 Func<bool> start = null) {
    Native.Given(facts, nameof(facts));
    Native.Given(read, nameof(read));
    Native.Given(command, nameof(command));
    var callbacks = new Callbacks(facts, read, command, stop, start);
    GCHandle user = GCHandle.Alloc(callbacks);
    try {
      Native.fb_device_callbacks native = Callbacks.Table(GCHandle.ToIntPtr(user), stop != null, start != null);
      IntPtr made;
      Native.Check(Native.fb_device_of_callbacks(facts.Handle, &native, out made));
      return new Device(new Native.DeviceHandle(made, user), callbacks);
    } catch {
      user.Free();
      throw;
    }
  }

  private Device(Native.DeviceHandle handle, Callbacks callbacks) {
    this.handle = handle;
    Callbacks = callbacks;
  }

  internal Callbacks Callbacks { get; }
  internal Native.DeviceHandle Handle => Native.Open(handle, nameof(Device));

  /// <summary>How often a callback threw, so far.</summary>
  public long CallbacksThrew => Callbacks == null ? 0 : Callbacks.Thrown.Count;
  /// <summary>The first that was thrown; null: none was.</summary>
  public Exception FirstThrown => Callbacks?.Thrown.First;

  /// <summary>A client that was made with it keeps it, and its callbacks, until the client's own end.</summary>
  public void Dispose() => handle.Dispose();
}

// Exceptions that delegates threw when the library called them: none goes on into C.
internal sealed class Thrown {
  private long count;
  private Exception first;

  internal long Count => Interlocked.Read(ref count);
  internal Exception First => Volatile.Read(ref first);

  internal int Catch(Exception exception) {
    Interlocked.CompareExchange(ref first, exception, null);
    Interlocked.Increment(ref count);
    // Else it goes on at the end of the catch clause, into C.
    if (exception is ThreadAbortException) Thread.ResetAbort();
    return Native.FB_FAILED;
  }

  // Once for each run of exceptions: who asks again is told only of new ones.
  internal static void Report(Thrown thrown, int status, ref long reported, string whose) {
    long threw = thrown == null ? 0 : thrown.Count;
    long before = Interlocked.Exchange(ref reported, threw);
    if (status != Native.FB_OK) Native.Check(status, thrown?.First);
    if (threw == before) return;
    Exception first = thrown.First;
    throw new ForceboundException(Status.Failed, "a callback of the " + whose + " threw " + (threw - before) +
                                  " times, with zero force each time; first: " + first.GetType().Name + ": " +
                                  first.Message.Split('\n')[0].TrimEnd(), first);
  }
}

// Between the library's thread and the delegates. Static functions, since IL2CPP calls no others from C.
internal sealed class Callbacks {
  private static readonly unsafe Native.Read staticRead = Read;
  private static readonly unsafe Native.Command staticCommand = Command;
  private static readonly Native.Stop staticStop = Stop;
  private static readonly Native.Start staticStart = Start;

  private readonly ReadDevice read;
  private readonly CommandDevice command;
  private readonly Action stop;
  private readonly Func<bool> start;
  private readonly Reading reading;
  private readonly double[] force_N;
  private int commanding;

  internal Callbacks(Facts facts, ReadDevice read, CommandDevice command, Action stop, Func<bool> start) {
    this.read = read;
    this.command = command;
    this.stop = stop;
    this.start = start;
    reading = new Reading(facts);
    force_N = new double[facts.Axes];
  }

  internal static unsafe Native.fb_device_callbacks Table(IntPtr user, bool stops, bool starts) {
    return new Native.fb_device_callbacks {
      size = (UIntPtr)sizeof(Native.fb_device_callbacks),
      user = user,
      read = Marshal.GetFunctionPointerForDelegate(staticRead),
      command = Marshal.GetFunctionPointerForDelegate(staticCommand),
      stop = stops ? Marshal.GetFunctionPointerForDelegate(staticStop) : IntPtr.Zero,
      start = starts ? Marshal.GetFunctionPointerForDelegate(staticStart) : IntPtr.Zero
    };
  }

  internal readonly Thrown Thrown = new Thrown();

  private static Callbacks Of(IntPtr user) => (Callbacks)GCHandle.FromIntPtr(user).Target;

  [MonoPInvokeCallback(typeof(Native.Read))]
  private static unsafe int Read(IntPtr user, Native.fb_reading* native) {
    Callbacks of = Of(user);
    try {
      of.reading.Latched_ns = native->latched_ns;
      if (!of.read(of.reading)) return Native.FB_FAILED;
      of.reading.Write(native);
      return Native.FB_OK;
    } catch (Exception e) {
      return of.Thrown.Catch(e);
    }
  }

  [MonoPInvokeCallback(typeof(Native.Command))]
  private static unsafe int Command(IntPtr user, double* force_N, UIntPtr axes) {
    Callbacks of = Of(user);
    // The library may command zero on a second thread while a command is in progress, which must not wait for it.
    bool first = Interlocked.CompareExchange(ref of.commanding, 1, 0) == 0;
    try {
      double[] copy = first ? of.force_N : new double[of.force_N.Length];
      for (int k = 0; k < copy.Length; ++k) copy[k] = k < (int)axes ? force_N[k] : 0;
      return of.command(copy) ? Native.FB_OK : Native.FB_FAILED;
    } catch (Exception e) {
      return of.Thrown.Catch(e);
    } finally {
      if (first) Volatile.Write(ref of.commanding, 0);
    }
  }

  [MonoPInvokeCallback(typeof(Native.Stop))]
  private static void Stop(IntPtr user) {
    Callbacks of = Of(user);
    try {
      of.stop();
    } catch (Exception e) {
      of.Thrown.Catch(e);
    }
  }

  [MonoPInvokeCallback(typeof(Native.Start))]
  private static int Start(IntPtr user) {
    Callbacks of = Of(user);
    try {
      return of.start() ? Native.FB_OK : Native.FB_FAILED;
    } catch (Exception e) {
      return of.Thrown.Catch(e);
    }
  }
}

// IL2CPP looks for an attribute of this name.
[AttributeUsage(AttributeTargets.Method)]
internal sealed class MonoPInvokeCallbackAttribute : Attribute {
  public MonoPInvokeCallbackAttribute(Type type) { Type = type; }
  public Type Type { get; }
}

/// <summary>Only Server has to be set. See fb_client_settings.</summary>
public sealed class ClientSettings {
  /// <summary>HOST:PORT.</summary>
  public string Server;
  /// <summary>Null: the server's default.</summary>
  public string Scene;
  /// <summary>Null: "fba-exact".</summary>
  public string Law;
  public string LawParameters;
  /// <summary>File of the client's secret key; null: a new one.</summary>
  public string Key;
  /// <summary>The server's public key in base64, or its file.</summary>
  public string ServerKey;
  /// <summary>File of servers and their keys.</summary>
  public string KnownServers;
  public string SharedKey;
  /// <summary>MCAP file of each tick and force; null: none.</summary>
  public string Recording;
  /// <summary>0: until stopped.</summary>
  public double Duration_s;
  public bool TrustNew;
  public bool Insecure;
  public bool RemoteRendering;
  /// <summary>Give up if the server does not answer for 5 s, or refuses another session.</summary>
  public bool Once;

  internal unsafe Native.fb_client_settings Write(Native.Texts texts) {
    return new Native.fb_client_settings {
      size = (UIntPtr)sizeof(Native.fb_client_settings),
      server = texts.Add(Server, nameof(Server)),
      scene = texts.Add(Scene, nameof(Scene)),
      law = texts.Add(Law, nameof(Law)),
      law_parameters = texts.Add(LawParameters, nameof(LawParameters)),
      key = texts.Add(Key, nameof(Key)),
      server_key = texts.Add(ServerKey, nameof(ServerKey)),
      known_servers = texts.Add(KnownServers, nameof(KnownServers)),
      shared_key = texts.Add(SharedKey, nameof(SharedKey)),
      recording = texts.Add(Recording, nameof(Recording)),
      duration_s = Duration_s,
      trust_new = TrustNew ? 1 : 0,
      insecure = Insecure ? 1 : 0,
      remote_rendering = RemoteRendering ? 1 : 0,
      once = Once ? 1 : 0
    };
  }
}

/// <summary>Of a client with its server.</summary>
public enum Session {
  Connecting = Native.FB_SESSION_CONNECTING,
  Active = Native.FB_SESSION_ACTIVE,
  Stale = Native.FB_SESSION_STALE,
  Reconnecting = Native.FB_SESSION_RECONNECTING
}

/// <summary>The newest tick; made once, then filled by Client.Look. See fb_client_state.</summary>
public sealed class ClientState {
  /// <summary>So far; 0: there was none, and what follows is zero.</summary>
  public ulong Ticks;
  public bool IsRunning;
  public Session Session;
  public readonly double[] Position_m = new double[Native.FB_AXES_MAX];
  /// <summary>What was asked for, and below it the torque [N m].</summary>
  public readonly double[] Request_N = new double[Native.FB_AXES_MAX];
  /// <summary>What the law made of it: commanded.</summary>
  public readonly double[] Force_N = new double[Native.FB_AXES_MAX];
  /// <summary>Since the reading that the newest answer of the server is for.</summary>
  public double ForceAge_s;
  public bool IsInContact;
  public uint Buttons;
  public double Depth_m;
  /// <summary>Unit quaternion w, x, y, z; zeros: none.</summary>
  public readonly double[] Orientation = new double[4];
  public double Gripper;
  /// <summary>They said so, or threw.</summary>
  public ulong CallbacksFailed;
  /// <summary>Took more than 10 ms.</summary>
  public ulong CallbacksLate;
  public ulong EventsLost;
  /// <summary>What the server simulates; empty: no session yet.</summary>
  public string Simulated = "";

  internal unsafe void Read(Native.fb_client_state* from) {
    Ticks = from->ticks;
    IsRunning = from->running != 0;
    Session = (Session)from->session;
    for (int k = 0; k < Native.FB_AXES_MAX; ++k) {
      Position_m[k] = from->position_m[k];
      Request_N[k] = from->request_N[k];
      Force_N[k] = from->force_N[k];
    }
    ForceAge_s = from->force_age_s;
    IsInContact = from->contact != 0;
    Buttons = from->buttons;
    Depth_m = from->depth_m;
    for (int k = 0; k < Orientation.Length; ++k) Orientation[k] = from->orientation[k];
    Gripper = from->gripper;
    CallbacksFailed = from->callbacks_failed;
    CallbacksLate = from->callbacks_late;
    EventsLost = from->events_lost;
    if (!Native.Says(from->simulated, Simulated)) Simulated = Native.Text((IntPtr)from->simulated);
  }
}

/// <summary>Programs ignore those that they do not know. See fb_event.</summary>
public enum EventKind {
  Welcomed = Native.FB_EVENT_WELCOMED,
  Refused = Native.FB_EVENT_REFUSED,
  SessionUnknown = Native.FB_EVENT_SESSION_UNKNOWN,
  ServerLeft = Native.FB_EVENT_SERVER_LEFT,
  ForceFading = Native.FB_EVENT_FORCE_FADING,
  ForceDropped = Native.FB_EVENT_FORCE_DROPPED,
  ForceFresh = Native.FB_EVENT_FORCE_FRESH,
  SceneHere = Native.FB_EVENT_SCENE_HERE,
  SceneRefused = Native.FB_EVENT_SCENE_REFUSED,
  Limited = Native.FB_EVENT_LIMITED,
  DeviceGone = Native.FB_EVENT_DEVICE_GONE,
  NoTorque = Native.FB_EVENT_NO_TORQUE,
  DeviceBack = Native.FB_EVENT_DEVICE_BACK,
  Follower = Native.FB_EVENT_FOLLOWER,
  ToolLost = Native.FB_EVENT_TOOL_LOST,
  Problem = Native.FB_EVENT_PROBLEM
}

/// <summary>What happened, for a log.</summary>
public struct Event {
  public EventKind Kind;
  public double Duration_s;
  public string Text;

  public override string ToString() => Text.Length == 0 ? Kind.ToString() : Kind + ": " + Text;
}

/// <summary>The device and a law at work against a server, on a thread of the library. Any thread. The end of the program
/// ends it too.</summary>
public sealed class Client : IDisposable {
  private readonly Native.ClientHandle handle;
  private readonly Thrown thrown;
  private bool started;
  private long reported;

  /// <summary>Looks up the server, opens the recording, reads the keys. A device serves one client at a time.</summary>
  public unsafe Client(ClientSettings settings, Device device) {
    Native.Given(settings, nameof(settings));
    Native.Given(device, nameof(device));
    thrown = device.Callbacks?.Thrown;
    using (var texts = new Native.Texts()) {
      Native.fb_client_settings native = settings.Write(texts);
      IntPtr made;
      Native.Check(Native.fb_client_create(&native, device.Handle, out made));
      handle = new Native.ClientHandle(made, device.Handle);
    }
  }

  /// <summary>Starts the device and the thread. Once.</summary>
  public void Start() {
    Native.Check(Native.fb_client_start(Open));
    started = true;
    Running.Add(handle);
  }

  /// <summary>Waits until it has ended. @returns false if it still runs after so long.</summary>
  /// <param name="timeout_s">Below 0: however long it takes.</param>
  /// <exception cref="ForceboundException">It was never started, there never was a session, or a callback threw.
  /// </exception>
  public bool Wait(double timeout_s = -1) {
    int status = Native.fb_client_wait(Open, timeout_s);
    if (status == Native.FB_NOT_NOW && started) return false;
    End(status);
    return true;
  }

  /// <summary>Zero force, then says good-bye to the server, which takes up to 3 s.</summary>
  /// <exception cref="ForceboundException">As Wait.</exception>
  public void Stop() => End(Native.fb_client_stop(Open));

  /// <summary>Fills `state`. Never makes the tick wait. Tick, unless what the server simulates has changed.</summary>
  public unsafe void Look(ClientState state) {
    Native.Given(state, nameof(state));
    var native = new Native.fb_client_state { size = (UIntPtr)sizeof(Native.fb_client_state) };
    Native.Check(Native.fb_client_look(Open, &native));
    state.Read(&native);
  }

  /// <summary>Of its law at the newest tick, and P where the device is simulated.</summary>
  public unsafe Ledger Ledger() {
    var ledger = new Ledger();
    ledger.native.size = (UIntPtr)sizeof(Native.fb_ledger);
    Native.Check(Native.fb_client_ledger(Open, &ledger.native));
    return ledger;
  }

  /// <summary>The oldest event that waits, which then is taken; false: none does.</summary>
  public unsafe bool TryTake(out Event taken) {
    var native = new Native.fb_event { size = (UIntPtr)sizeof(Native.fb_event) };
    int status = Native.fb_client_event(Open, &native);
    taken = default(Event);
    if (status == Native.FB_NOTHING) return false;
    Native.Check(status);
    taken.Kind = (EventKind)native.kind;
    taken.Duration_s = native.duration_s;
    taken.Text = Native.Text((IntPtr)native.text);
    return true;
  }

  /// <summary>After the end: JSON, as `forcebound-client --summary` writes it.</summary>
  public string Summary() {
    Native.ClientHandle open = Open;
    return Native.Summary((byte[] text, UIntPtr bytes, out UIntPtr needed) =>
                              Native.fb_client_summary(open, text, bytes, out needed));
  }

  private Native.ClientHandle Open => Native.Open(handle, nameof(Client));

  private void End(int status) => Thrown.Report(thrown, status, ref reported, "device");

  /// <summary>Stops it first.</summary>
  public void Dispose() {
    if (handle.IsClosed) return;
    // Others that wait for its end go on.
    if (started) Native.fb_client_stop(handle);
    handle.Dispose();
  }
}

/// <summary>A client that asks for the environment, by its own account. See fb_client_facts.</summary>
public sealed class ClientFacts {
  internal unsafe ClientFacts(Native.fb_client_facts* from) {
    Device = Native.Text((IntPtr)from->device);
    Axes = from->axes;
    RendersLocally = from->renders_locally != 0;
    ShowsTorque = from->shows_torque != 0;
    Period_s = from->period_s;
    ForceMax_N = from->force_N_max;
    RoundTrip_s = from->round_trip_s;
  }

  public string Device { get; }
  public int Axes { get; }
  /// <summary>It takes a stiffness.</summary>
  public bool RendersLocally { get; }
  /// <summary>It takes a torque on the handle.</summary>
  public bool ShowsTorque { get; }
  /// <summary>Between its motions.</summary>
  public double Period_s { get; }
  public double ForceMax_N { get; }
  /// <summary>0: not measured.</summary>
  public double RoundTrip_s { get; }
}

/// <summary>A motion of a client's device. See fb_client_motion.</summary>
public sealed class ClientMotion {
  internal ClientMotion(int axes) { Position_m = new double[axes]; }

  /// <summary>The client's clock at the reading: it may jump, and be wrong on purpose.</summary>
  public long Read_ns;
  /// <summary>CLOCK_MONOTONIC at its arrival here.</summary>
  public long Arrived_ns;
  public readonly double[] Position_m;
  /// <summary>Bit k: button k is pressed; null: it has none.</summary>
  public uint? Buttons;
  /// <summary>0: closed, 1: open; null: it has none.</summary>
  public double? Gripper;
  /// <summary>Whether Orientation, a unit quaternion w, x, y, z, is known.</summary>
  public bool HasOrientation;
  public readonly double[] Orientation = { 1, 0, 0, 0 };

  internal unsafe void Read(Native.fb_client_motion* from) {
    Read_ns = from->read_ns;
    Arrived_ns = from->arrived_ns;
    for (int k = 0; k < Position_m.Length; ++k) Position_m[k] = from->position_m[k];
    Buttons = (from->has & Native.FB_HAS_BUTTONS) != 0 ? from->buttons : (uint?)null;
    Gripper = (from->has & Native.FB_HAS_GRIPPER) != 0 ? from->gripper : (double?)null;
    HasOrientation = (from->has & Native.FB_HAS_ORIENTATION) != 0;
    for (int k = 0; HasOrientation && k < Orientation.Length; ++k) Orientation[k] = from->orientation[k];
  }
}

/// <summary>The answer to a motion: zeros, until it is set. See fb_answer.</summary>
public sealed class Answer {
  internal Answer(int axes) {
    Force_N = new double[axes];
    Normal = new double[axes];
  }

  public readonly double[] Force_N;
  public bool HasTorque;
  /// <summary>On the handle, for a device whose motions have no rotations.</summary>
  public readonly double[] Torque_N_m = new double[3];
  public bool HasContact;
  /// <summary>Unit, out of the surface that is touched.</summary>
  public readonly double[] Normal;
  public double Depth_m;
  public bool HasStiffness;
  /// <summary>K of x, y and z, row by row: to a client that renders locally the force is f - K (x - x_0), at its own
  /// rate, for Radius_m about the motion's position x_0.</summary>
  public readonly double[] Stiffness_N_per_m = new double[9];
  public double Radius_m;

  internal void Clear() {
    HasTorque = HasContact = HasStiffness = false;
    Depth_m = Radius_m = 0;
    Array.Clear(Force_N, 0, Force_N.Length);
    Array.Clear(Torque_N_m, 0, Torque_N_m.Length);
    Array.Clear(Normal, 0, Normal.Length);
    Array.Clear(Stiffness_N_per_m, 0, Stiffness_N_per_m.Length);
  }

  internal unsafe void Write(Native.fb_answer* to) {
    to->has = (HasTorque ? (uint)Native.FB_HAS_TORQUE : 0) | (HasContact ? (uint)Native.FB_HAS_CONTACT : 0) |
              (HasStiffness ? (uint)Native.FB_HAS_STIFFNESS : 0);
    for (int k = 0; k < Force_N.Length; ++k) to->force_N[k] = Force_N[k];
    for (int k = 0; k < Torque_N_m.Length; ++k) to->torque_N_m[k] = Torque_N_m[k];
    for (int k = 0; k < Normal.Length; ++k) to->normal[k] = Normal[k];
    to->depth_m = Depth_m;
    for (int k = 0; k < Stiffness_N_per_m.Length; ++k) to->stiffness_N_per_m[k] = Stiffness_N_per_m[k];
    to->radius_m = Radius_m;
  }
}

/// <summary>Answers a motion of one client; false: not done, and zero force is sent. To return within a tick, without
/// waiting or allocating: all other clients wait meanwhile. Both objects are used again.</summary>
public delegate bool AnswerMotion(ClientMotion motion, Answer answer);

/// <summary>What a server serves. Beside `using System` it is Forcebound.Environment. An exception of its delegates ends in
/// here: zero force, counted, and reported by the server's Stop. One that takes more than 10 ms is answered late, and
/// counted.</summary>
public sealed class Environment {
  private static readonly unsafe Native.Create staticCreate = Create;
  private static readonly unsafe Native.Update staticUpdate = Update;
  private static readonly Native.Stop staticDestroy = Destroy;

  // One client's.
  private sealed class Felt {
    internal Environment Of;
    internal AnswerMotion Update;
    internal ClientMotion Motion;
    internal Answer Answer;
  }

  private readonly Func<ClientFacts, AnswerMotion> create;
  private readonly Action<AnswerMotion> left;
  internal readonly Thrown Thrown = new Thrown();

  /// <param name="create">Of a client that comes, what answers its motions; null refuses it, and so does an exception.
  /// </param>
  /// <param name="left">The client of this one has left; null: nothing is to be done.</param>
  public Environment(Func<ClientFacts, AnswerMotion> create, Action<AnswerMotion> left = null) {
    Native.Given(create, nameof(create));
    this.create = create;
    this.left = left;
  }

  /// <summary>By which clients may ask for it, as for a scene; null: "environment".</summary>
  public string Name;
  /// <summary>What it is, in one line for people; null: its name.</summary>
  public string Simulated;
  /// <summary>Of the devices that it accepts; 0: any.</summary>
  public int Axes;

  /// <summary>How often a delegate threw, so far.</summary>
  public long CallbacksThrew => Thrown.Count;
  /// <summary>The first that was thrown; null: none was.</summary>
  public Exception FirstThrown => Thrown.First;

  internal unsafe Native.fb_environment Write(Native.Texts texts, IntPtr user) {
    return new Native.fb_environment {
      size = (UIntPtr)sizeof(Native.fb_environment),
      name = texts.Add(Name, nameof(Name)),
      simulated = texts.Add(Simulated, nameof(Simulated)),
      axes = Axes,
      user = user,
      create = Marshal.GetFunctionPointerForDelegate(staticCreate),
      update = Marshal.GetFunctionPointerForDelegate(staticUpdate),
      destroy = Marshal.GetFunctionPointerForDelegate(staticDestroy)
    };
  }

  private static T Target<T>(IntPtr handle) => (T)GCHandle.FromIntPtr(handle).Target;

  [MonoPInvokeCallback(typeof(Native.Create))]
  private static unsafe int Create(IntPtr user, Native.fb_client_facts* client, IntPtr* own) {
    Environment of = Target<Environment>(user);
    try {
      var facts = new ClientFacts(client);
      AnswerMotion update = of.create(facts);
      if (update == null) return Native.FB_FAILED;
      var felt = new Felt { Of = of, Update = update, Motion = new ClientMotion(facts.Axes),
                            Answer = new Answer(facts.Axes) };
      *own = GCHandle.ToIntPtr(GCHandle.Alloc(felt));
      return Native.FB_OK;
    } catch (Exception e) {
      return of.Thrown.Catch(e);
    }
  }

  [MonoPInvokeCallback(typeof(Native.Update))]
  private static unsafe int Update(IntPtr own, Native.fb_client_motion* motion, Native.fb_answer* answer) {
    Felt felt = Target<Felt>(own);
    try {
      felt.Motion.Read(motion);
      felt.Answer.Clear();
      if (!felt.Update(felt.Motion, felt.Answer)) return Native.FB_FAILED;
      felt.Answer.Write(answer);
      return Native.FB_OK;
    } catch (Exception e) {
      return felt.Of.Thrown.Catch(e);
    }
  }

  [MonoPInvokeCallback(typeof(Native.Stop))]
  private static void Destroy(IntPtr own) {
    Felt felt = Target<Felt>(own);
    GCHandle.FromIntPtr(own).Free();
    try {
      felt.Of.left?.Invoke(felt.Update);
    } catch (Exception e) {
      felt.Of.Thrown.Catch(e);
    }
  }
}

/// <summary>Nothing has to be set. See fb_server_settings.</summary>
public sealed class ServerSettings {
  /// <summary>HOST:PORT; null: "127.0.0.1:47800"; port 0: a free one, see ServerState.</summary>
  public string Listen;
  /// <summary>File of the server's secret key; takes Clients, SharedKey or both.</summary>
  public string Key;
  /// <summary>TOML file of the clients that are let in.</summary>
  public string Clients;
  public string SharedKey;
  /// <summary>Other machines are served, not encrypted.</summary>
  public bool Insecure;
  /// <summary>At once; 0: 64.</summary>
  public int ClientsMax;
  /// <summary>At once, of one IP address; 0: as many.</summary>
  public int ClientsPerAddress;
  /// <summary>A client ends that sends no motion for so long; 0: 60 s.</summary>
  public double Idle_s;

  internal unsafe Native.fb_server_settings Write(Native.Texts texts) {
    return new Native.fb_server_settings {
      size = (UIntPtr)sizeof(Native.fb_server_settings),
      listen = texts.Add(Listen, nameof(Listen)),
      key = texts.Add(Key, nameof(Key)),
      clients = texts.Add(Clients, nameof(Clients)),
      shared_key = texts.Add(SharedKey, nameof(SharedKey)),
      insecure = Insecure ? 1 : 0,
      clients_max = ClientsMax,
      clients_per_address = ClientsPerAddress,
      idle_s = Idle_s
    };
  }
}

/// <summary>As of 0.1 s ago at most. See fb_server_state.</summary>
public struct ServerState {
  public bool IsRunning;
  public int Port;
  /// <summary>"127.0.0.1:47800".</summary>
  public string Address;
  /// <summary>Now.</summary>
  public ulong Clients;
  public ulong ClientsRefused;
  /// <summary>Received.</summary>
  public ulong Motions;
  /// <summary>Sent,</summary>
  public ulong Forces;
  /// <summary>of them for want of a sound answer.</summary>
  public ulong ForcesZero;
  /// <summary>They said so, or threw.</summary>
  public ulong CallbacksFailed;
  /// <summary>Took more than 10 ms.</summary>
  public ulong CallbacksLate;
  /// <summary>Share of its thread's time, of the last second.</summary>
  public double Busy;
  /// <summary>Of a simulator, accepted.</summary>
  public ulong Reports;
  public ulong ReportsRefused;
  /// <summary>Times that a probe had no report for 0.25 s.</summary>
  public ulong Silences;
}

/// <summary>A simulator that steps on its own thread at its own rate. See fb_simulator.</summary>
public sealed class Simulator {
  /// <summary>By which clients may ask for it, as for a scene; null: "simulator".</summary>
  public string Name;
  /// <summary>What it is, in one line for people; null: its name.</summary>
  public string Simulated;
  /// <summary>0: a point.</summary>
  public double ProbeRadius_m;
  /// <summary>0: 0.03.</summary>
  public double ProbeMass_kg;
  /// <summary>Of the coupling: no wall feels harder; 0: 2000.</summary>
  public double ProbeStiffness_N_per_m;
  /// <summary>0: 8.</summary>
  public double ProbeDamping_N_s_per_m;

  internal unsafe Native.fb_simulator Write(Native.Texts texts) {
    return new Native.fb_simulator {
      size = (UIntPtr)sizeof(Native.fb_simulator),
      name = texts.Add(Name, nameof(Name)),
      simulated = texts.Add(Simulated, nameof(Simulated)),
      probe_radius_m = ProbeRadius_m,
      probe_mass_kg = ProbeMass_kg,
      probe_stiffness_N_per_m = ProbeStiffness_N_per_m,
      probe_damping_N_s_per_m = ProbeDamping_N_s_per_m
    };
  }
}

/// <summary>What a probe gave a place that was reported, since it was asked for before: a step of h seconds applies
/// Impulse_Ns / h. See fb_push.</summary>
public struct Push {
  /// <summary>As it was reported.</summary>
  public uint Body;
  /// <summary>Likewise.</summary>
  public double[] Place_m;
  public double[] Impulse_Ns;
}

/// <summary>A client's probe as it was asked for. See fb_probe.</summary>
public struct Probe {
  /// <summary>A number that no other client has, before or after.</summary>
  public ulong Client;
  /// <summary>Since it was asked for before; 0: the first time, or no motion came since.</summary>
  public double Interval_s;
  /// <summary>Its centre.</summary>
  public double[] Place_m;
  public double[] Velocity_m_per_s;
  public double[] Device_m;
  /// <summary>Bit k: button k is pressed.</summary>
  public uint Buttons;
  public Push[] Pushes;
}

/// <summary>A place that a probe touches or may soon meet. See fb_touch, which says what is set to what.</summary>
public struct Touch {
  public uint Body;
  /// <summary>Of the surface, nearest to the probe's centre.</summary>
  public double[] Place_m;
  /// <summary>Unit, out of the surface.</summary>
  public double[] Normal;
  /// <summary>Of the surface there; null: it stands.</summary>
  public double[] Velocity_m_per_s;
  /// <summary>3 x 3, row by row; null: it stands.</summary>
  public double[] Mobility_per_kg;
  /// <summary>On it there, of all but the probe; null: nothing.</summary>
  public double[] Others_N;
  public double Spring_N_per_m;
  public double Damper_N_s_per_m;
  public double DryFriction_N;
  /// <summary>Of the probe along the surface.</summary>
  public double Friction;
  /// <summary>The surface goes on so far; 0: for ever.</summary>
  public double Radius_m;

  internal unsafe void Write(Native.fb_touch* to) {
    to->size = (UIntPtr)sizeof(Native.fb_touch);
    to->body = Body;
    Native.Copy(Place_m, to->place_m, 3, nameof(Place_m));
    Native.Copy(Normal, to->normal, 3, nameof(Normal));
    if (Velocity_m_per_s != null) Native.Copy(Velocity_m_per_s, to->velocity_m_per_s, 3, nameof(Velocity_m_per_s));
    if (Mobility_per_kg != null) Native.Copy(Mobility_per_kg, to->mobility_per_kg, 9, nameof(Mobility_per_kg));
    if (Others_N != null) Native.Copy(Others_N, to->others_N, 3, nameof(Others_N));
    to->spring_N_per_m = Spring_N_per_m;
    to->damper_N_s_per_m = Damper_N_s_per_m;
    to->dry_friction_N = DryFriction_N;
    to->friction = Friction;
    to->radius_m = Radius_m;
  }
}

/// <summary>An environment for any number of clients, on a thread of the library. Any thread. The end of the program ends
/// it too.</summary>
public sealed class Server : IDisposable {
  private readonly Native.ServerHandle handle;
  private readonly Thrown thrown;
  private long reported;

  /// <summary>Takes the address, reads the keys.</summary>
  public unsafe Server(Environment environment, ServerSettings settings = null) {
    Library.Require();
    Native.Given(environment, nameof(environment));
    thrown = environment.Thrown;
    GCHandle user = GCHandle.Alloc(environment);
    try {
      using (var texts = new Native.Texts()) {
        Native.fb_server_settings native = (settings ?? new ServerSettings()).Write(texts);
        Native.fb_environment felt = environment.Write(texts, GCHandle.ToIntPtr(user));
        IntPtr made;
        Native.Check(Native.fb_server_create(&native, &felt, out made));
        handle = new Native.ServerHandle(made, user);
      }
    } catch {
      user.Free();
      throw;
    }
  }

  /// <summary>Takes the address, reads the keys. Once it is started, one thread at a time calls Ask and Report.</summary>
  public unsafe Server(Simulator simulator, ServerSettings settings = null) {
    Library.Require();
    Native.Given(simulator, nameof(simulator));
    thrown = new Thrown();
    using (var texts = new Native.Texts()) {
      Native.fb_server_settings native = (settings ?? new ServerSettings()).Write(texts);
      Native.fb_simulator stepped = simulator.Write(texts);
      IntPtr made;
      Native.Check(Native.fb_server_of_simulator(&native, &stepped, out made));
      handle = new Native.ServerHandle(made, default(GCHandle));
    }
  }

  /// <summary>Of a simulator: where the probes are, and what they did since it was asked last. Before each step.</summary>
  public unsafe Probe[] Ask() {
    UIntPtr count;
    Native.Check(Native.fb_server_ask(Open, out count));
    var probes = new Probe[(int)count];
    for (int k = 0; k < probes.Length; ++k) {
      var native = new Native.fb_probe { size = (UIntPtr)sizeof(Native.fb_probe) };
      Native.Check(Native.fb_server_probe(Open, (UIntPtr)k, &native));
      probes[k] = new Probe {
        Client = native.client,
        Interval_s = native.interval_s,
        Place_m = Native.Copied(native.place_m, 3),
        Velocity_m_per_s = Native.Copied(native.velocity_m_per_s, 3),
        Device_m = Native.Copied(native.device_m, 3),
        Buttons = native.buttons,
        Pushes = new Push[native.push_count]
      };
      for (int i = 0; i < probes[k].Pushes.Length; ++i) {
        var push = new Native.fb_push { size = (UIntPtr)sizeof(Native.fb_push) };
        Native.Check(Native.fb_server_push(Open, (UIntPtr)k, (UIntPtr)i, &push));
        probes[k].Pushes[i] = new Push { Body = push.body, Place_m = Native.Copied(push.place_m, 3),
                                         Impulse_Ns = Native.Copied(push.impulse_Ns, 3) };
      }
    }
    return probes;
  }

  /// <summary>Of a simulator, after its step: what a probe meets, three places at most; none: nothing.</summary>
  /// <returns>False: that client has left.</returns>
  public unsafe bool Report(ulong client, params Touch[] touches) {
    Native.Given(touches, nameof(touches));
    Native.fb_touch* native = stackalloc Native.fb_touch[Native.FB_TOUCHES_MAX];
    for (int k = 0; k < Math.Min(touches.Length, Native.FB_TOUCHES_MAX); ++k) {
      native[k] = new Native.fb_touch();
      touches[k].Write(&native[k]);
    }
    int status = Native.fb_server_report(Open, client, native, (UIntPtr)touches.Length);
    if (status != Native.FB_NOT_NOW) Native.Check(status);
    return status == Native.FB_OK;
  }

  /// <summary>Starts the thread. Once.</summary>
  public void Start() {
    Native.Check(Native.fb_server_start(Open));
    Running.Add(handle);
  }

  /// <summary>Says good-bye to all clients. Not in a delegate of its environment.</summary>
  /// <exception cref="ForceboundException">It was not started, it failed, or a delegate threw.</exception>
  public void Stop() => Thrown.Report(thrown, Native.fb_server_stop(Open), ref reported, "environment");

  public unsafe ServerState Look() {
    var native = new Native.fb_server_state { size = (UIntPtr)sizeof(Native.fb_server_state) };
    Native.Check(Native.fb_server_look(Open, &native));
    return new ServerState {
      IsRunning = native.running != 0,
      Port = native.port,
      Address = Native.Text((IntPtr)native.address),
      Clients = native.clients,
      ClientsRefused = native.clients_refused,
      Motions = native.motions,
      Forces = native.forces,
      ForcesZero = native.forces_zero,
      CallbacksFailed = native.callbacks_failed,
      CallbacksLate = native.callbacks_late,
      Busy = native.busy,
      Reports = native.reports,
      ReportsRefused = native.reports_refused,
      Silences = native.silences
    };
  }

  /// <summary>JSON: the state, and every count that forcebound-server prints at its end.</summary>
  public string Summary() {
    Native.ServerHandle open = Open;
    return Native.Summary((byte[] text, UIntPtr bytes, out UIntPtr needed) =>
                              Native.fb_server_summary(open, text, bytes, out needed));
  }

  private Native.ServerHandle Open => Native.Open(handle, nameof(Server));

  /// <summary>Stops it first.</summary>
  public void Dispose() => handle.Dispose();
}

// Ends what runs when the program does: a callback must not be called into a runtime that is being taken down.
internal static class Running {
  private static readonly List<WeakReference> all = new List<WeakReference>();

  static Running() {
    AppDomain.CurrentDomain.ProcessExit += (sender, end) => End();
    AppDomain.CurrentDomain.DomainUnload += (sender, end) => End();
  }

  internal static void Add(SafeHandle started) {
    lock (all) {
      all.RemoveAll(one => !one.IsAlive);
      all.Add(new WeakReference(started));
    }
  }

  private static void End() {
    lock (all) {
      foreach (WeakReference one in all) (one.Target as SafeHandle)?.Dispose();
      all.Clear();
    }
  }
}

// The header as it is: names, fields and values are compared with it by a test.
internal static unsafe class Native {
  private const string Name = "forcebound";
  private const CallingConvention C = CallingConvention.Cdecl;

  internal const int FB_ABI = 1;
  internal const int FB_AXES_MAX = 6;
  internal const int FB_JOINTS_MAX = 7;
  internal const int FB_TEXT_BYTES = 256;
  internal const int FB_TOUCHES_MAX = 3;
  internal const int FB_OK = 0;
  internal const int FB_INVALID = 1;
  internal const int FB_FAILED = 2;
  internal const int FB_NOT_NOW = 3;
  internal const int FB_NOTHING = 4;
  internal const int FB_TOO_SMALL = 5;
  internal const int FB_NO_MEMORY = 6;
  internal const int FB_HAS_LATENCY = 1;
  internal const int FB_HAS_LATENCY_MAX = 2;
  internal const int FB_HAS_EFFECT = 4;
  internal const int FB_HAS_HELD = 8;
  internal const int FB_HAS_BUTTONS = 16;
  internal const int FB_HAS_GRIPPER = 32;
  internal const int FB_HAS_ORIENTATION = 64;
  internal const int FB_HAS_TORQUE = 128;
  internal const int FB_HAS_CONTACT = 256;
  internal const int FB_HAS_STIFFNESS = 512;
  internal const int FB_SESSION_CONNECTING = 0;
  internal const int FB_SESSION_ACTIVE = 1;
  internal const int FB_SESSION_STALE = 2;
  internal const int FB_SESSION_RECONNECTING = 3;
  internal const int FB_EVENT_WELCOMED = 0;
  internal const int FB_EVENT_REFUSED = 1;
  internal const int FB_EVENT_SESSION_UNKNOWN = 2;
  internal const int FB_EVENT_SERVER_LEFT = 3;
  internal const int FB_EVENT_FORCE_FADING = 4;
  internal const int FB_EVENT_FORCE_DROPPED = 5;
  internal const int FB_EVENT_FORCE_FRESH = 6;
  internal const int FB_EVENT_SCENE_HERE = 7;
  internal const int FB_EVENT_SCENE_REFUSED = 8;
  internal const int FB_EVENT_LIMITED = 9;
  internal const int FB_EVENT_DEVICE_GONE = 10;
  internal const int FB_EVENT_NO_TORQUE = 11;
  internal const int FB_EVENT_DEVICE_BACK = 12;
  internal const int FB_EVENT_FOLLOWER = 13;
  internal const int FB_EVENT_TOOL_LOST = 14;
  internal const int FB_EVENT_PROBLEM = 1000;

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_facts_info {
    public UIntPtr size;
    public fixed byte name[FB_TEXT_BYTES];
    public int axes;
    public int rotations;
    public int joints;
    public int cartesian;
    public int identified;
    public int reserved;
    public double period_s;
    public double force_N_max;
    public double torque_N_m_max;
    public double latency_s;
    public double hold_s_max;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_law_options {
    public UIntPtr size;
    public IntPtr parameters;
    public int full_memory;
    public int reserved;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_motion {
    public UIntPtr size;
    public uint has;
    public int write_failed;
    public double interval_s;
    public fixed double position[FB_AXES_MAX];
    public fixed double joint[FB_JOINTS_MAX];
    public fixed double jacobian[FB_AXES_MAX * FB_JOINTS_MAX];
    public double latency_s;
    public double latency_s_max;
    public double effect_s;
    public double held_s;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_ledger {
    public UIntPtr size;
    public double energy_J;
    public double share_credited;
    public int audited;
    public int reserved;
    public double P_J;
    public double P_J_least;
    public ulong requests_not_finite;
    public ulong readings_not_finite;
    public ulong readings_too_far;
    public ulong writes_failed;
    public ulong effects_outside_facts;
    public ulong releases_outside_facts;
    public ulong intervals_impossible;
    public ulong saturated;
    public ulong forces_not_finite;
    public ulong forces_withdrawn;
    public ulong calls_refused;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_leader_joint {
    public UIntPtr size;
    public IntPtr name;
    public double damping_N_m_s_per_rad;
    public double friction_N_m;
    public double encoder_step_rad;
    public double backlash_rad;
    public double torque_N_m_max;
    public double torque_step_N_m;
    public double torque_gain_share;
    public double torque_ripple_share;
    public double speed_rad_per_s_max;
    public double goal_stiffness_N_m_per_rad;
    public double goal_rad_least;
    public double goal_rad_most;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_leader_settings {
    public UIntPtr size;
    public double period_s;
    public double latency_s_max;
    public double read_s_max;
    public double hold_s_max;
    public double watchdog_s_least;
    public double clock_share;
    public double memory_J;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_leader_state {
    public UIntPtr size;
    public double energy_J_least;
    public ulong readings_lost;
    public ulong feedback_not_finite;
    public ulong saturated;
    public ulong intervals_impossible;
    public ulong late;
    public ulong writes_failed;
    public ulong calls_refused;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_reading {
    public UIntPtr size;
    public uint has;
    public uint buttons;
    public long latched_ns;
    public fixed double position_m[FB_AXES_MAX];
    public fixed double joint[FB_JOINTS_MAX];
    public fixed double jacobian[FB_AXES_MAX * FB_JOINTS_MAX];
    public fixed double orientation[4];
    public double gripper;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_device_callbacks {
    public UIntPtr size;
    public IntPtr user;
    public IntPtr read;
    public IntPtr command;
    public IntPtr stop;
    public IntPtr start;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_client_settings {
    public UIntPtr size;
    public IntPtr server;
    public IntPtr scene;
    public IntPtr law;
    public IntPtr law_parameters;
    public IntPtr key;
    public IntPtr server_key;
    public IntPtr known_servers;
    public IntPtr shared_key;
    public IntPtr recording;
    public double duration_s;
    public int trust_new;
    public int insecure;
    public int remote_rendering;
    public int once;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_client_state {
    public UIntPtr size;
    public ulong ticks;
    public int running;
    public int session;
    public fixed double position_m[FB_AXES_MAX];
    public fixed double request_N[FB_AXES_MAX];
    public fixed double force_N[FB_AXES_MAX];
    public double force_age_s;
    public int contact;
    public uint buttons;
    public double depth_m;
    public fixed double orientation[4];
    public double gripper;
    public ulong callbacks_failed;
    public ulong callbacks_late;
    public ulong events_lost;
    public fixed byte simulated[FB_TEXT_BYTES];
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_event {
    public UIntPtr size;
    public int kind;
    public int reserved;
    public double duration_s;
    public fixed byte text[1024];
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_client_facts {
    public UIntPtr size;
    public fixed byte device[FB_TEXT_BYTES];
    public int axes;
    public int renders_locally;
    public int shows_torque;
    public int reserved;
    public double period_s;
    public double force_N_max;
    public double round_trip_s;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_client_motion {
    public UIntPtr size;
    public uint has;
    public uint buttons;
    public long read_ns;
    public long arrived_ns;
    public fixed double position_m[FB_AXES_MAX];
    public fixed double orientation[4];
    public double gripper;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_answer {
    public UIntPtr size;
    public uint has;
    public uint reserved;
    public fixed double force_N[FB_AXES_MAX];
    public fixed double torque_N_m[3];
    public fixed double normal[FB_AXES_MAX];
    public double depth_m;
    public fixed double stiffness_N_per_m[9];
    public double radius_m;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_environment {
    public UIntPtr size;
    public IntPtr name;
    public IntPtr simulated;
    public int axes;
    public int reserved;
    public IntPtr user;
    public IntPtr create;
    public IntPtr update;
    public IntPtr destroy;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_server_settings {
    public UIntPtr size;
    public IntPtr listen;
    public IntPtr key;
    public IntPtr clients;
    public IntPtr shared_key;
    public int insecure;
    public int clients_max;
    public int clients_per_address;
    public int reserved;
    public double idle_s;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_server_state {
    public UIntPtr size;
    public int running;
    public int port;
    public fixed byte address[FB_TEXT_BYTES];
    public ulong clients;
    public ulong clients_refused;
    public ulong motions;
    public ulong forces;
    public ulong forces_zero;
    public ulong callbacks_failed;
    public ulong callbacks_late;
    public double busy;
    public ulong reports;
    public ulong reports_refused;
    public ulong silences;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_simulator {
    public UIntPtr size;
    public IntPtr name;
    public IntPtr simulated;
    public double probe_radius_m;
    public double probe_mass_kg;
    public double probe_stiffness_N_per_m;
    public double probe_damping_N_s_per_m;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_probe {
    public UIntPtr size;
    public ulong client;
    public double interval_s;
    public fixed double place_m[3];
    public fixed double velocity_m_per_s[3];
    public fixed double device_m[3];
    public uint buttons;
    public uint push_count;
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_push {
    public UIntPtr size;
    public uint body;
    public uint reserved;
    public fixed double place_m[3];
    public fixed double impulse_Ns[3];
  }

  [StructLayout(LayoutKind.Sequential)]
  internal struct fb_touch {
    public UIntPtr size;
    public uint body;
    public uint reserved;
    public fixed double place_m[3];
    public fixed double normal[3];
    public fixed double velocity_m_per_s[3];
    public fixed double mobility_per_kg[9];
    public fixed double others_N[3];
    public double spring_N_per_m;
    public double damper_N_s_per_m;
    public double dry_friction_N;
    public double friction;
    public double radius_m;
  }

  [UnmanagedFunctionPointer(C)] internal delegate int Read(IntPtr user, fb_reading* reading);
  [UnmanagedFunctionPointer(C)] internal delegate int Command(IntPtr user, double* force_N, UIntPtr axes);
  [UnmanagedFunctionPointer(C)] internal delegate void Stop(IntPtr user);
  [UnmanagedFunctionPointer(C)] internal delegate int Start(IntPtr user);
  [UnmanagedFunctionPointer(C)] internal delegate int Create(IntPtr user, fb_client_facts* client, IntPtr* own);
  [UnmanagedFunctionPointer(C)]
  internal delegate int Update(IntPtr own, fb_client_motion* motion, fb_answer* answer);

  [DllImport(Name, CallingConvention = C)] internal static extern IntPtr fb_last_error();
  [DllImport(Name, CallingConvention = C)] internal static extern IntPtr fb_version();
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_facts_load(byte[] name_or_path, out IntPtr facts);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_facts_parse(byte[] toml, byte[] name, out IntPtr facts);
  [DllImport(Name, CallingConvention = C)] internal static extern void fb_facts_destroy(IntPtr facts);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_facts_describe(FactsHandle facts, fb_facts_info* info);
  [DllImport(Name, CallingConvention = C)] internal static extern IntPtr fb_law_name(UIntPtr index);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_law_create(byte[] name, FactsHandle facts, fb_law_options* options, out IntPtr law);
  [DllImport(Name, CallingConvention = C)] internal static extern void fb_law_destroy(IntPtr law);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_law_tick(LawHandle law, fb_motion* motion, double* request_N, double* force_N,
                                         UIntPtr axes);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_law_confirm(LawHandle law, double latency_s, double* force_N, UIntPtr axes);
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_law_ledger(LawHandle law, fb_ledger* ledger);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_leader_create(fb_leader_joint* joints, UIntPtr count, fb_leader_settings* settings,
                                              out IntPtr leader);
  [DllImport(Name, CallingConvention = C)]
  internal static extern void fb_leader_destroy(IntPtr leader);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_leader_step(LeaderHandle leader, double* position_rad, double* feedback_N_m,
                                            double interval_s, double* torque_N_m, UIntPtr joints);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_leader_write_failed(LeaderHandle leader);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_leader_goals(LeaderHandle leader, double* goal_rad, UIntPtr joints);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_leader_look(LeaderHandle leader, fb_leader_state* state);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_device_open(byte[] device, byte[] hand, out IntPtr opened);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_device_of_callbacks(FactsHandle facts, fb_device_callbacks* callbacks, out IntPtr device);
  [DllImport(Name, CallingConvention = C)] internal static extern void fb_device_destroy(IntPtr device);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_client_create(fb_client_settings* settings, DeviceHandle device, out IntPtr client);
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_client_start(ClientHandle client);
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_client_wait(ClientHandle client, double timeout_s);
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_client_stop(ClientHandle client);
  [DllImport(Name, CallingConvention = C)] internal static extern void fb_client_destroy(IntPtr client);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_client_look(ClientHandle client, fb_client_state* state);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_client_ledger(ClientHandle client, fb_ledger* ledger);
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_client_event(ClientHandle client, fb_event* taken);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_client_summary(ClientHandle client, byte[] text, UIntPtr bytes, out UIntPtr needed);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_create(fb_server_settings* settings, fb_environment* environment,
                                              out IntPtr server);
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_server_start(ServerHandle server);
  [DllImport(Name, CallingConvention = C)] internal static extern int fb_server_stop(ServerHandle server);
  [DllImport(Name, CallingConvention = C)] internal static extern void fb_server_destroy(IntPtr server);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_look(ServerHandle server, fb_server_state* state);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_summary(ServerHandle server, byte[] text, UIntPtr bytes, out UIntPtr needed);

  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_of_simulator(fb_server_settings* settings, fb_simulator* simulator,
                                                    out IntPtr server);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_ask(ServerHandle server, out UIntPtr probes);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_probe(ServerHandle server, UIntPtr index, fb_probe* probe);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_push(ServerHandle server, UIntPtr probe, UIntPtr index, fb_push* push);
  [DllImport(Name, CallingConvention = C)]
  internal static extern int fb_server_report(ServerHandle server, ulong client, fb_touch* touches, UIntPtr count);

  internal abstract class Handle : SafeHandle {
    protected Handle(IntPtr made) : base(IntPtr.Zero, true) { SetHandle(made); }
    public override bool IsInvalid => handle == IntPtr.Zero;
  }

  internal sealed class FactsHandle : Handle {
    internal FactsHandle(IntPtr made) : base(made) {}
    protected override bool ReleaseHandle() {
      fb_facts_destroy(handle);
      return true;
    }
  }

  internal sealed class LawHandle : Handle {
    internal LawHandle(IntPtr made) : base(made) {}
    protected override bool ReleaseHandle() {
      fb_law_destroy(handle);
      return true;
    }
  }

  internal sealed class LeaderHandle : Handle {
    internal LeaderHandle(IntPtr made) : base(made) {}
    protected override bool ReleaseHandle() {
      fb_leader_destroy(handle);
      return true;
    }
  }

  internal sealed class DeviceHandle : Handle {
    private GCHandle user;

    internal DeviceHandle(IntPtr made, GCHandle user) : base(made) { this.user = user; }
    protected override bool ReleaseHandle() {
      fb_device_destroy(handle);
      if (user.IsAllocated) user.Free();
      return true;
    }
  }

  // Keeps the environment, whose delegates the library calls until the server's end.
  internal sealed class ServerHandle : Handle {
    private GCHandle user;

    internal ServerHandle(IntPtr made, GCHandle user) : base(made) { this.user = user; }
    protected override bool ReleaseHandle() {
      fb_server_destroy(handle);
      if (user.IsAllocated) user.Free();
      return true;
    }
  }

  // Keeps the device, whose callbacks the library calls until the client's end.
  internal sealed class ClientHandle : Handle {
    private readonly DeviceHandle device;

    internal ClientHandle(IntPtr made, DeviceHandle device) : base(made) {
      bool added = false;
      device.DangerousAddRef(ref added);
      this.device = device;
    }
    protected override bool ReleaseHandle() {
      fb_client_destroy(handle);
      device.DangerousRelease();
      return true;
    }
  }

  /// Texts in C for one call.
  internal sealed class Texts : IDisposable {
    private readonly List<IntPtr> all = new List<IntPtr>();

    internal IntPtr Add(string text, string name) {
      if (text == null) return IntPtr.Zero;
      byte[] bytes = Utf8(text, name);
      IntPtr copy = Marshal.AllocHGlobal(bytes.Length);
      all.Add(copy);
      Marshal.Copy(bytes, 0, copy, bytes.Length);
      return copy;
    }

    public void Dispose() {
      foreach (IntPtr text in all) Marshal.FreeHGlobal(text);
      all.Clear();
    }
  }

  internal static byte[] Utf8(string text, string name) {
    Given(text, name);
    if (text.IndexOf('\0') >= 0) {
      throw new ArgumentException(name + " has a zero character at " + text.IndexOf('\0') + ", accepted is text without",
                                  name);
    }
    return Encoding.UTF8.GetBytes(text + '\0');
  }

  internal static string Text(IntPtr text) {
    int length = 0;
    while (((byte*)text)[length] != 0) ++length;
    var bytes = new byte[length];
    Marshal.Copy(text, bytes, 0, length);
    return Encoding.UTF8.GetString(bytes);
  }

  internal delegate int GiveText(byte[] text, UIntPtr bytes, out UIntPtr needed);

  /// A text of which the library tells how long it is; longer meanwhile, it is asked for again.
  internal static string Summary(GiveText give) {
    UIntPtr needed;
    int status = give(null, UIntPtr.Zero, out needed);
    for (;;) {
      if (status != FB_TOO_SMALL) Check(status);
      var text = new byte[(int)needed];
      status = give(text, needed, out needed);
      if (status == FB_OK) return Encoding.UTF8.GetString(text, 0, (int)needed - 1);
    }
  }

  /// Whether text in C is this one; false for all that is not ASCII.
  internal static bool Says(byte* text, string expected) {
    for (int k = 0; k < expected.Length; ++k) {
      if (text[k] == 0 || text[k] != expected[k]) return false;
    }
    return text[expected.Length] == 0;
  }

  internal static void Check(int status, Exception inner = null) {
    if (status != FB_OK) throw new ForceboundException((Status)status, Text(fb_last_error()), inner);
  }

  internal static void Given(object argument, string name) {
    if (argument == null) throw new ArgumentNullException(name, name + " is null");
  }

  internal static void Length(double[] array, int expected, string name) {
    if (array != null && array.Length == expected) return;
    throw new ArgumentException(name + (array == null ? " is null" : " has " + array.Length + " numbers") + ", expected " +
                                expected, name);
  }

  internal static void Copy(double[] from, double* to, int length, string name) {
    Length(from, length, name);
    Marshal.Copy(from, 0, (IntPtr)to, length);
  }

  internal static double[] Copied(double* from, int length) {
    var copy = new double[length];
    Marshal.Copy((IntPtr)from, copy, 0, length);
    return copy;
  }

  internal static T Open<T>(T handle, string name) where T : SafeHandle {
    if (handle.IsClosed) throw new ObjectDisposedException("Forcebound." + name);
    return handle;
  }
}

}
