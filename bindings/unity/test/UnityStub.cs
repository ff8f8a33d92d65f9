// The part of UnityEngine that the package uses, so that its scripts compile and run without Unity. Hand-written from
// Unity's reference; it proves nothing about Unity itself.
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    [AttributeUsage(AttributeTargets.Class)]
    public sealed class AddComponentMenu : Attribute
    {
        public AddComponentMenu(string menuName) { }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class HeaderAttribute : Attribute
    {
        public HeaderAttribute(string header) { }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string tooltip) { }
    }

    public struct Color
    {
        public float r, g, b, a;
        public Color(float r, float g, float b) { this.r = r; this.g = g; this.b = b; a = 1.0f; }
    }

    public struct Vector2
    {
        public float x, y;
    }

    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 zero { get { return new Vector3(); } }
        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
        public static Vector3 operator -(Vector3 v) { return new Vector3(-v.x, -v.y, -v.z); }
        public static Vector3 operator *(float f, Vector3 v) { return new Vector3(f * v.x, f * v.y, f * v.z); }
    }

    public struct Quaternion
    {
        public float x, y, z, w;
        public Quaternion(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }
        public static Quaternion Euler(float x, float y, float z) { return new Quaternion(0, 0, 0, 1); }
        public static Vector3 operator *(Quaternion q, Vector3 v)
        {
            // v + 2 w (u x v) + 2 u x (u x v)
            float ax = q.y * v.z - q.z * v.y, ay = q.z * v.x - q.x * v.z, az = q.x * v.y - q.y * v.x;
            return new Vector3(v.x + 2 * (q.w * ax + q.y * az - q.z * ay), v.y + 2 * (q.w * ay + q.z * ax - q.x * az),
                               v.z + 2 * (q.w * az + q.x * ay - q.y * ax));
        }
    }

    public class Object
    {
        public string name;
        public static int destroyed;
        public static void Destroy(Object one) { ++destroyed; }
    }

    public class Component : Object
    {
        public GameObject gameObject;
        public string tag { get { return gameObject.tag; } set { gameObject.tag = value; } }
        public Transform transform { get { return gameObject.transform; } }
        public T[] GetComponentsInChildren<T>() where T : Component
        {
            var found = new List<T>();
            transform.Collect(found);
            return found.ToArray();
        }
    }

    public sealed class Transform : Component
    {
        public Vector3 localPosition, localScale = Vector3.one, position;
        public Quaternion localRotation = new Quaternion(0, 0, 0, 1), rotation;
        public readonly List<Transform> children = new List<Transform>();
        public void SetParent(Transform parent, bool worldPositionStays) { parent.children.Add(this); }
        public void LookAt(Vector3 point) { }
        public void Collect<T>(List<T> found) where T : Component
        {
            foreach (Component one in gameObject.components) if (one is T) found.Add((T)one);
            foreach (Transform child in children) child.Collect(found);
        }
    }

    public sealed class GameObject : Object
    {
        public string tag = "";
        public bool active = true;
        public readonly List<Component> components = new List<Component>();
        public readonly Transform transform;
        public GameObject(string name)
        {
            this.name = name;
            transform = AddComponent<Transform>();
        }
        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            var made = new GameObject("Sphere");
            made.AddComponent<MeshRenderer>().sharedMaterial = new Material(null);
            return made;
        }
        public T AddComponent<T>() where T : Component, new()
        {
            var added = new T { gameObject = this };
            components.Add(added);
            return added;
        }
        public T GetComponent<T>() where T : Component { return (T)components.Find(one => one is T); }
        public void SetActive(bool value) { active = value; }
    }

    public class Behaviour : Component
    {
        public bool enabled = true;
    }

    public class MonoBehaviour : Behaviour { }
    public sealed class TextAsset : Object { public string text; }
    public sealed class Material : Object
    {
        public Color color;
        public Material(Material source) { }
    }
    public sealed class MeshFilter : Component { public Mesh sharedMesh; }
    public sealed class MeshRenderer : Component { public Material sharedMaterial; }
    public enum PrimitiveType { Sphere }
    public sealed class Camera : Behaviour
    {
        public float nearClipPlane;
        public static Camera main { get { return null; } }
    }
    public enum LightType { Directional = 1 }
    public sealed class Light : Behaviour { public LightType type; }

    public sealed class Mesh : Object
    {
        private Vector3[] kept = new Vector3[0];
        public Rendering.IndexFormat indexFormat;
        public int[] triangles;
        public Vector3[] vertices { get { return (Vector3[])kept.Clone(); } set { kept = (Vector3[])value.Clone(); } }
        public void MarkDynamic() { }
        public void RecalculateNormals() { }
        public void RecalculateBounds() { }
    }

    public static class Debug
    {
        public static string last = "";
        public static void Log(object message, Object context) { }
        public static void LogWarning(object message, Object context) { last = message.ToString(); }
        public static void LogError(object message) { last = message.ToString(); }
        public static void LogError(object message, Object context) { last = message.ToString(); }
    }

    public enum KeyCode { Alpha1 = 49 }

    public static class Input
    {
        public static float mouseY;
        public static Vector2 mouseScrollDelta { get { return new Vector2(); } }
        public static float GetAxis(string axis) { return axis == "Mouse Y" ? mouseY : 0.0f; }
        public static bool GetKeyDown(KeyCode key) { return false; }
        public static bool GetMouseButton(int button) { return button == 1; }
    }

    public sealed class GUILayoutOption { }

    public static class GUILayout
    {
        public static void Label(string text, params GUILayoutOption[] options) { }
    }
}

namespace UnityEngine.Rendering
{
    public enum IndexFormat { UInt16, UInt32 }
}
