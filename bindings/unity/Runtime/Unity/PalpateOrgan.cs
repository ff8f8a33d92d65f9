#if UNITY_5_3_OR_NEWER
using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Rendering;

namespace Palpate
{
    /// <summary>
    /// Loads a scene, runs its haptic loop on a thread, and shows organ and instruments as children of this object.
    /// Frame and unit of Palpate's world are those of this object's transform, one metre per unit.
    /// </summary>
    [AddComponentMenu("Palpate/Organ")]
    public sealed class PalpateOrgan : MonoBehaviour
    {
        [Header("Scene (read when the component is enabled)")]
        [Tooltip("A scene in TOML, named .txt for Unity. Empty: the built-in press, or the pull if Task is pull.")]
        public TextAsset scene;

        [Tooltip("Folder of relative paths in the scene. Empty: the working folder.")]
        public string sceneFolder = "";

        [Tooltip("press, pull, palpate or insert. Empty: the scene's task.")]
        public string task = "";

        [Tooltip("One component per hand. A missing one: a scripted motion.")]
        public HapticDeviceBehaviour[] devices = new HapticDeviceBehaviour[0];

        [Tooltip("On if a device can push a hand: force ramp, passivity controller and watchdog act.")]
        public bool handHoldsDevice;

        [Tooltip("Longest edge of the visible surface in millimetres, 0.1 to 1000. 0: edges of the organ's mesh.")]
        public float surfaceEdgeMm;

        [Header("Live (applied when changed)")]
        [Tooltip("Built-in tissue or tissue file. Empty: the scene's tissue.")]
        public string tissue = "";

        [Tooltip("Off: no touch noise. The scene sets this when it opens.")]
        public bool touchNoise;

        [Tooltip("Gain of the touch noise in N m. The scene sets this when it opens.")]
        public double noiseGain;

        [Tooltip("Distance threshold of the touch noise in metres. The scene sets this when it opens.")]
        public double noiseThreshold;

        [Header("Picture")]
        [Tooltip("Empty: red, with the shader of the project's primitives.")]
        public Material organMaterial;

        [Tooltip("Empty: grey, with the shader of the project's primitives.")]
        public Material toolMaterial;

        private readonly List<Transform[]> parts = new List<Transform[]>(); // per hand, its parts
        private readonly List<Transform> tools = new List<Transform>();
        private Result[] results = new Result[0];
        private Picture picture;
        private double[] xyz;
        private Vector3[] vertices;
        private Mesh mesh;
        private Transform organ;
        private string tissueUsed;
        private bool noiseUsed;
        private double gainUsed, thresholdUsed;

        /// <summary>Null while the component is disabled, or after an error.</summary>
        public Simulation Simulation { get; private set; }

        public HapticLoop Loop { get; private set; }

        /// <summary>One per hand, as of this frame, in Palpate's world frame.</summary>
        public Result[] Results { get { return results; } }

        private void OnEnable()
        {
            try
            {
                Open();
            }
            catch (Exception error)
            {
                Debug.LogError("Palpate: " + error.Message, this);
                Close();
                enabled = false;
            }
        }

        private void OnDisable()
        {
            Close();
        }

        private void Update()
        {
            if (Simulation == null) return;
            if (Loop.Failure != null)
            {
                Debug.LogError("Palpate: a device failed, the haptic loop has ended: " + Loop.Failure.Message, this);
                enabled = false;
                return;
            }
            ApplyChanges();
            Loop.CopyResults(results);
            ShowPicture();
        }

        private void Open()
        {
            Simulation = Simulation.Open(new SimulationOptions
            {
                SceneText = scene == null ? null : scene.text,
                SceneFolder = OrNull(sceneFolder),
                Task = OrNull(task),
                NoHand = !handHoldsDevice,
                SurfaceEdge = 1e-3 * surfaceEdgeMm
            });
            foreach (string remark in Simulation.Remarks()) Debug.Log("Palpate: " + remark, this);
            if (organMaterial == null) organMaterial = Coloured(new Color(0.7f, 0.25f, 0.2f));
            if (toolMaterial == null) toolMaterial = Coloured(new Color(0.6f, 0.6f, 0.65f));
            tissueUsed = "";
            Simulation.GetNoise(out touchNoise, out noiseGain, out noiseThreshold);
            noiseUsed = touchNoise;
            gainUsed = noiseGain;
            thresholdUsed = noiseThreshold;
            MakeOrgan();
            for (int hand = 0; hand < Simulation.Hands; ++hand) MakeTool(hand);
            results = new Result[Simulation.Hands];
            var opened = new IHapticDevice[Simulation.Hands];
            for (int hand = 0; hand < opened.Length; ++hand)
            {
                HapticDeviceBehaviour own = hand < devices.Length ? devices[hand] : null;
                opened[hand] = own != null ? own.Open(Simulation, hand) : new ScriptedDevice(Simulation, hand);
            }
            ShowPicture();
            Loop = new HapticLoop(Simulation, opened);
            Loop.Start();
        }

        private void Close()
        {
            if (Loop != null) Loop.Dispose();
            Loop = null;
            if (Simulation != null) Simulation.Dispose();
            Simulation = null;
            if (organ != null) Remove(organ);
            organ = null;
            foreach (Transform tool in tools) Remove(tool);
            tools.Clear();
            parts.Clear();
        }

        private void ApplyChanges()
        {
            try
            {
                if (tissue != tissueUsed)
                {
                    tissueUsed = tissue;
                    if (tissue != "") Simulation.SetTissue(tissue);
                }
                if (touchNoise == noiseUsed && noiseGain == gainUsed && noiseThreshold == thresholdUsed) return;
                noiseUsed = touchNoise;
                gainUsed = noiseGain;
                thresholdUsed = noiseThreshold;
                Simulation.SetNoise(touchNoise, noiseGain, noiseThreshold);
            }
            catch (PalpateException error)
            {
                Debug.LogWarning("Palpate: " + error.Message, this);
            }
        }

        private void ShowPicture()
        {
            Simulation.UpdateSurface(ref picture);
            Simulation.CopyVertices(xyz);
            UnityFrame.Vertices(xyz, vertices);
            mesh.vertices = vertices;
            mesh.RecalculateNormals();
            mesh.RecalculateBounds();
            Place(organ, picture.OrganPosition, picture.OrganOrientation);
            for (int hand = 0; hand < tools.Count; ++hand)
            {
                Place(tools[hand], picture.ToolPosition(hand), picture.ToolOrientation(hand));
                for (int part = 0; part < parts[hand].Length; ++part)
                {
                    Vec3d position;
                    Quatd orientation;
                    Simulation.PartPose(hand, part, picture.Gripper(hand), out position, out orientation);
                    Place(parts[hand][part], position, orientation);
                }
            }
        }

        private void MakeOrgan()
        {
            xyz = new double[3 * Simulation.Info.Vertices];
            vertices = new Vector3[Simulation.Info.Vertices];
            Simulation.CopyVertices(xyz);
            mesh = MakeMesh("Palpate organ", xyz, Simulation.Triangles());
            mesh.MarkDynamic();
            organ = Child("Organ", transform, mesh, organMaterial);
        }

        private void MakeTool(int hand)
        {
            Transform tool = Child("Tool " + hand, transform, null, null);
            tools.Add(tool);
            var all = new Transform[Simulation.Info.ToolParts(hand)];
            parts.Add(all);
            for (int part = 0; part < all.Length; ++part)
            {
                Mesh shape = MakeMesh("Palpate tool", Simulation.PartVertices(hand, part),
                                      Simulation.PartTriangles(hand, part));
                all[part] = Child(Simulation.GetPart(hand, part).Name, tool, shape, toolMaterial);
            }
        }

        private static Mesh MakeMesh(string name, double[] xyz, int[] corners)
        {
            var points = new Vector3[xyz.Length / 3];
            UnityFrame.Vertices(xyz, points);
            var made = new Mesh { name = name };
            if (points.Length > 65535) made.indexFormat = IndexFormat.UInt32;
            made.vertices = points;
            made.triangles = UnityFrame.Triangles(corners);
            made.RecalculateNormals();
            return made;
        }

        private static Transform Child(string name, Transform parent, Mesh shape, Material material)
        {
            var child = new GameObject(name);
            child.transform.SetParent(parent, false);
            if (shape != null)
            {
                child.AddComponent<MeshFilter>().sharedMesh = shape;
                child.AddComponent<MeshRenderer>().sharedMaterial = material;
            }
            return child.transform;
        }

        /// <summary>The material of a primitive suits the project's render pipeline.</summary>
        private static Material Coloured(Color colour)
        {
            GameObject primitive = GameObject.CreatePrimitive(PrimitiveType.Sphere);
            var made = new Material(primitive.GetComponent<MeshRenderer>().sharedMaterial) { color = colour };
            Destroy(primitive);
            return made;
        }

        /// <summary>Meshes are no garbage: Unity keeps them until they are destroyed.</summary>
        private static void Remove(Transform shown)
        {
            foreach (MeshFilter filter in shown.GetComponentsInChildren<MeshFilter>()) Destroy(filter.sharedMesh);
            Destroy(shown.gameObject);
        }

        private static void Place(Transform shown, Vec3d position, Quatd orientation)
        {
            shown.localPosition = UnityFrame.Vector(position);
            shown.localRotation = UnityFrame.Rotation(orientation);
        }

        private static string OrNull(string text)
        {
            return string.IsNullOrEmpty(text) ? null : text;
        }
    }
}
#endif
