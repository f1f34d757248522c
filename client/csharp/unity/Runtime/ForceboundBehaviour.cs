using System;
using UnityEngine;

namespace Forcebound.Unity {

/// <summary>Connects a haptic device to a Forcebound server while it is enabled, and draws the tip and the force on it.
/// The haptic loop of 1 kHz is a thread of the library; this only looks at it, once a frame.</summary>
[AddComponentMenu("Forcebound/Haptic device")]
public sealed class ForceboundBehaviour : MonoBehaviour {
  [Header("Server")]
  [Tooltip("HOST:PORT of forcebound-server or a relay")]
  public string server = "127.0.0.1:47800";
  [Tooltip("Empty: the server's default")]
  public string scene = "";
  [Tooltip("The server's public key, or its file; needed off this machine")]
  public string serverKey = "";
  [Tooltip("File of this client's secret key; empty: a new one")]
  public string key = "";
  [Tooltip("All forces are computed at the server")]
  public bool remoteRendering;

  [Header("Device")]
  [Tooltip("Simulated (omni), or behind a driver (evdev:path=...)")]
  public string device = "omni";
  [Tooltip("That moves a simulated device; empty: its default")]
  public string hand = "trace-sphere";
  public string law = "fba-exact";

  [Header("Drawing")]
  [Tooltip("Empty: a sphere is made")]
  public Transform tip;
  [Tooltip("Empty: a line is made")]
  public LineRenderer force;
  [Tooltip("Unity's units for a metre of the device")]
  public float unitsPerMetre = 10f;
  [Tooltip("Length of a newton [m]")]
  public float metresPerNewton = 0.01f;

  /// <summary>The newest tick, in the scene's frame; of the last frame.</summary>
  public ClientState State { get; } = new ClientState();

  private Device opened;
  private Client client;
  private bool ended;

  /// <summary>Unity's y is up and z away, and its frame is left-handed.</summary>
  public static Vector3 ToUnity(double x, double y, double z) => new Vector3((float)x, (float)z, (float)y);

  private static string OrNull(string text) => string.IsNullOrEmpty(text) ? null : text;

  private void OnEnable() {
    ended = false;
    try {
      opened = Device.Open(device, OrNull(hand));
      client = new Client(new ClientSettings { Server = server, Scene = OrNull(scene), Law = OrNull(law),
                                               Key = OrNull(key), ServerKey = OrNull(serverKey),
                                               RemoteRendering = remoteRendering },
                          opened);
      client.Start();
    } catch (Exception e) when (e is ForceboundException || e is DllNotFoundException || e is ArgumentException) {
      Debug.LogError("Forcebound: " + e.Message, this);
      OnDisable();
      return;
    }
    MakeWhatIsMissing();
  }

  private void MakeWhatIsMissing() {
    const float tip_m = 0.005f, line_m = 0.001f;
    if (tip == null) {
      tip = GameObject.CreatePrimitive(PrimitiveType.Sphere).transform;
      tip.SetParent(transform, false);
      tip.localScale = Vector3.one * (tip_m * unitsPerMetre);
    }
    if (force == null) {
      force = gameObject.AddComponent<LineRenderer>();
      force.widthMultiplier = line_m * unitsPerMetre;
    }
    force.useWorldSpace = false;
    force.positionCount = 2;
  }

  private void Update() {
    if (client == null) return;
    client.Look(State);
    Vector3 at = ToUnity(State.Position_m[0], State.Position_m[1], State.Position_m[2]) * unitsPerMetre;
    Vector3 push = ToUnity(State.Force_N[0], State.Force_N[1], State.Force_N[2]) * (metresPerNewton * unitsPerMetre);
    tip.localPosition = at;
    force.SetPosition(0, at);
    force.SetPosition(1, at + push);
    Event happened;
    while (client.TryTake(out happened)) Debug.Log("Forcebound: " + happened, this);
    if (!ended && State.Ticks > 0 && !State.IsRunning) ReportEnd();
  }

  private void ReportEnd() {
    ended = true;
    try {
      client.Wait(0);
    } catch (ForceboundException e) {
      Debug.LogError("Forcebound: " + e.Message, this);
    }
  }

  private void OnDisable() {
    client?.Dispose();
    opened?.Dispose();
    client = null;
    opened = null;
  }
}

}
