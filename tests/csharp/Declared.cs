// Prints what Forcebound.cs declares of the header, as the program does that declared.awk makes of the header itself.
using System;
using System.Collections.Generic;
using System.Reflection;
using System.Runtime.CompilerServices;
using System.Runtime.InteropServices;
using Forcebound;

static class Declared {
  const BindingFlags Any = BindingFlags.Static | BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic;

  static string Kind(Type type) {
    var kinds = new Dictionary<Type, string> { { typeof(double), "double" }, { typeof(int), "int" },
                                               { typeof(uint), "uint" },     { typeof(long), "long" },
                                               { typeof(ulong), "ulong" },   { typeof(UIntPtr), "ulong" },
                                               { typeof(byte), "text" },     { typeof(IntPtr), "pointer" } };
    return kinds[type];
  }

  static void PrintStruct(Type type) {
    Console.WriteLine("{0}: {1} bytes", type.Name, Marshal.SizeOf(type));
    foreach (FieldInfo field in type.GetFields(Any)) {
      var array = field.GetCustomAttribute<FixedBufferAttribute>();
      Type element = array == null ? field.FieldType : array.ElementType;
      int size = Marshal.SizeOf(element) * (array == null ? 1 : array.Length);
      Console.WriteLine("{0}.{1}: at {2}, {3} bytes, {4}", type.Name, field.Name, Marshal.OffsetOf(type, field.Name), size,
                        Kind(element));
    }
  }

  static void Main() {
    Type native = typeof(Client).Assembly.GetType("Forcebound.Native");
    foreach (FieldInfo constant in native.GetFields(Any)) {
      if (constant.Name.StartsWith("FB_")) Console.WriteLine("{0} = {1}", constant.Name, constant.GetRawConstantValue());
    }
    foreach (MethodInfo function in native.GetMethods(Any)) {
      if (!function.Name.StartsWith("fb_")) continue;
      Console.WriteLine("{0}({1})", function.Name, function.GetParameters().Length);
    }
    foreach (Type type in native.GetNestedTypes(Any)) {
      if (type.Name.StartsWith("fb_")) PrintStruct(type);
    }
  }
}
