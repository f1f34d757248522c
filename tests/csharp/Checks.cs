// Checks of Forcebound.cs, each by its name on the command line; what a server is needed for takes its address too.
using System;
using System.Globalization;
using System.Reflection;
using System.Threading;
using Forcebound;

static partial class Checks {
  sealed class Failed : Exception {
    public Failed(string message) : base(message) {}
  }

  static string server;

  static void Expect(bool holds, string what) {
    if (!holds) throw new Failed("expected: " + what);
  }

  static void ExpectIn(string part, string text) {
    if (!text.Contains(part)) throw new Failed("expected '" + part + "' in: " + text);
  }

  static T Thrown<T>(Action action, params string[] parts) where T : Exception {
    try {
      action();
    } catch (T thrown) {
      foreach (string part in parts) ExpectIn(part, thrown.Message);
      if (thrown is ForceboundException && thrown.Message.Contains("\n")) throw new Failed("one line: " + thrown.Message);
      return thrown;
    }
    throw new Failed("an exception " + typeof(T).Name);
  }

  static int Main(string[] arguments) {
    Thread.CurrentThread.CurrentCulture = CultureInfo.InvariantCulture;
    server = arguments.Length > 1 ? arguments[1] : null;
    MethodInfo check = typeof(Checks).GetMethod(arguments[0], BindingFlags.Static | BindingFlags.NonPublic);
    if (check == null) {
      Console.Error.WriteLine("there is no check '" + arguments[0] + "'");
      return 2;
    }
    try {
      ((Action)Delegate.CreateDelegate(typeof(Action), check))();
    } catch (Exception e) {
      Console.Error.WriteLine(arguments[0] + ": " + (e is Failed ? e.Message : e.ToString()));
      return 1;
    }
    Console.WriteLine(arguments[0] + ": passed");
    return 0;
  }
}
