// Plays the component of the Unity package for some frames, as Unity would, with stand-ins of Unity's types:
// PlayUnity.exe HOST:PORT. Ends with 0 once tip and force were drawn.
using System;
using System.Reflection;
using System.Threading;
using Forcebound.Unity;
using UnityEngine;

static class PlayUnity {
  static void Call(ForceboundBehaviour behaviour, string message) {
    typeof(ForceboundBehaviour).GetMethod(message, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(behaviour, null);
  }

  static bool Draws(ForceboundBehaviour behaviour) {
    const int frames = 1000, frame_ms = 20;
    for (int n = 0; n < frames; ++n) {
      Thread.Sleep(frame_ms);
      Call(behaviour, "Update");
      Vector3 at = behaviour.tip.localPosition, end = behaviour.force.GetPosition(1);
      bool pushed = end.x != at.x || end.y != at.y || end.z != at.z;
      if (pushed && Debug.Logged.Exists(line => line.StartsWith("Forcebound: Welcomed: "))) return true;
    }
    return false;
  }

  static int Main(string[] arguments) {
    var behaviour = new GameObject().AddComponent<ForceboundBehaviour>();
    behaviour.server = arguments[0];
    behaviour.scene = "sphere";
    Call(behaviour, "OnEnable");
    bool drew = Debug.Errors.Count == 0 && Draws(behaviour);
    Call(behaviour, "OnDisable");
    Call(behaviour, "Update");
    behaviour.device = "nothing-here";
    Call(behaviour, "OnEnable");
    foreach (string line in Debug.Logged) Console.WriteLine(line);
    foreach (string line in Debug.Errors) Console.WriteLine("error: " + line);
    bool refused = Debug.Errors.Count == 1 && Debug.Errors[0].Contains("nothing-here");
    return drew && refused ? 0 : 1;
  }
}
