// Stand-ins of what the component uses of Unity, by Unity's documentation: it compiles and runs without Unity.
using System;
using System.Collections.Generic;

namespace UnityEngine {

[AttributeUsage(AttributeTargets.Class)]
public sealed class AddComponentMenu : Attribute {
  public AddComponentMenu(string menuName) {}
}

[AttributeUsage(AttributeTargets.Field)]
public sealed class TooltipAttribute : Attribute {
  public TooltipAttribute(string tooltip) {}
}

[AttributeUsage(AttributeTargets.Field)]
public sealed class HeaderAttribute : Attribute {
  public HeaderAttribute(string header) {}
}

public struct Vector3 {
  public float x, y, z;

  public Vector3(float x, float y, float z) {
    this.x = x;
    this.y = y;
    this.z = z;
  }

  public static Vector3 one => new Vector3(1, 1, 1);
  public static Vector3 operator +(Vector3 a, Vector3 b) => new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
  public static Vector3 operator *(Vector3 a, float d) => new Vector3(a.x * d, a.y * d, a.z * d);
}

public class Object {}

public class Component : Object {
  public GameObject gameObject { get; internal set; }
  public Transform transform => gameObject.transform;
}

public class Behaviour : Component {}

public class MonoBehaviour : Behaviour {}

public class Transform : Component {
  public Vector3 localPosition { get; set; }
  public Vector3 localScale { get; set; }
  public void SetParent(Transform parent, bool worldPositionStays) {}
}

public sealed class LineRenderer : Component {
  private Vector3[] positions = {};

  public bool useWorldSpace { get; set; }
  public float widthMultiplier { get; set; }
  public int positionCount {
    get { return positions.Length; }
    set { positions = new Vector3[value]; }
  }
  public void SetPosition(int index, Vector3 position) { positions[index] = position; }
  public Vector3 GetPosition(int index) => positions[index];
}

public enum PrimitiveType { Sphere }

public sealed class GameObject : Object {
  public GameObject() { transform = AddTransform(); }

  public Transform transform { get; }

  private Transform AddTransform() => new Transform { gameObject = this };

  public T AddComponent<T>() where T : Component, new() => new T { gameObject = this };

  public static GameObject CreatePrimitive(PrimitiveType type) => new GameObject();
}

public static class Debug {
  public static readonly List<string> Logged = new List<string>();
  public static readonly List<string> Errors = new List<string>();
  public static void Log(object message, Object context) { Logged.Add(message.ToString()); }
  public static void LogError(object message, Object context) { Errors.Add(message.ToString()); }
}

}
