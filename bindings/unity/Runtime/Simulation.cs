using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Palpate
{
    /// <summary>What Simulation.Open() loads. Without a scene: the built-in gallbladder press.</summary>
    public sealed class SimulationOptions
    {
        /// <summary>A scene file (TOML). At most one of SceneFile and SceneText.</summary>
        public string SceneFile;
        public string SceneText;
        /// <summary>Folder of relative paths in SceneText; null: the working folder.</summary>
        public string SceneFolder;
        /// <summary>"press", "pull", "palpate" or "insert"; null: the scene's task.</summary>
        public string Task;
        /// <summary>File for a recording of every tick; null: none.</summary>
        public string RecordFile;
        /// <summary>Tick() waits for the disk instead of losing rows. Not for a loop in real time.</summary>
        public bool RecordWaits;
        /// <summary>No device can push a hand, so the full force applies at once. False: a force ramp and the
        /// passivity controller act.</summary>
        public bool NoHand;
        /// <summary>Neither reads nor writes the user's cache of prepared organs.</summary>
        public bool NoCache;
        /// <summary>m, longest edge of the visible surface, 1e-4 to 1; 0: edges of the organ's mesh.</summary>
        public double SurfaceEdge;
    }

    /// <summary>A sphere of another stiffness in the organ.</summary>
    public struct Inclusion
    {
        public string Name;
        /// <summary>m, of the centre, in the organ frame.</summary>
        public Vec3d Position;
        /// <summary>m.</summary>
        public double Radius;
        /// <summary>Young's modulus divided by that of the tissue.</summary>
        public double StiffnessRatio;
        /// <summary>False: hidden, for a search. Do not draw it.</summary>
        public bool Visible;
    }

    /// <summary>A rigid part of an instrument.</summary>
    public struct Part
    {
        public string Name;
        public int Vertices;
        public int Triangles;
        /// <summary>It rotates with the gripper.</summary>
        public bool IsJaw;
    }

    /// <summary>
    /// One organ with one instrument per hand. Units are SI; frames are Palpate's (right-handed, z up). Tick() and
    /// ScriptedSample() are for one thread, the haptic loop; they allocate no memory. UpdateSurface() and
    /// CopyVertices() are for one other thread. Open, Restart and Close need the simulation for themselves. All
    /// else is for any thread except the haptic loop's. Close the simulation: no finalizer does.
    /// </summary>
    public sealed class Simulation : IDisposable
    {
        private static readonly UIntPtr SampleSize = PalpateNative.SizeOf<Sample>();
        private static readonly UIntPtr ResultSize = PalpateNative.SizeOf<Result>();

        private IntPtr handle;
        private readonly Info info;

        /// <summary>Reads the scene and prepares the organ; the first time this may take seconds.</summary>
        /// <exception cref="PalpateException">an invalid scene, file or option</exception>
        public static Simulation Open(SimulationOptions options = null)
        {
            return new Simulation(options ?? new SimulationOptions());
        }

        private Simulation(SimulationOptions options)
        {
            uint abi = PalpateNative.palpate_abi_version();
            if (abi != PalpateNative.AbiVersion)
            {
                throw new PalpateException(ErrorKind.Use,
                    "the native library has interface " + abi + ", these scripts need " + PalpateNative.AbiVersion);
            }
            var texts = new List<IntPtr>();
            try
            {
                var native = new NativeOptions
                {
                    StructSize = PalpateNative.SizeOf<NativeOptions>(),
                    SceneFile = Unmanaged(options.SceneFile, texts),
                    SceneText = Unmanaged(options.SceneText, texts),
                    SceneFolder = Unmanaged(options.SceneFolder, texts),
                    Task = Unmanaged(options.Task, texts),
                    RecordFile = Unmanaged(options.RecordFile, texts),
                    RecordWaits = options.RecordWaits ? 1 : 0,
                    NoHand = options.NoHand ? 1 : 0,
                    NoCache = options.NoCache ? 1 : 0,
                    SurfaceEdge = options.SurfaceEdge
                };
                Check(PalpateNative.palpate_open(ref native, out handle));
            }
            finally
            {
                foreach (IntPtr text in texts) Marshal.FreeHGlobal(text);
            }
            info.StructSize = PalpateNative.SizeOf<Info>();
            Check(PalpateNative.palpate_get_info(handle, ref info));
        }

        /// <summary>The native library's version, for example "0.2.0".</summary>
        public static string Version { get { return PalpateNative.Text(PalpateNative.palpate_version()); } }

        /// <summary>Description of a fault.</summary>
        public static string Describe(Fault fault)
        {
            return PalpateNative.Text(PalpateNative.palpate_fault_words((uint)fault));
        }

        public Info Info { get { return info; } }
        public int Hands { get { return (int)info.Hands; } }
        public string Name { get { return PalpateNative.Text(PalpateNative.palpate_name(Handle)); } }

        /// <summary>Remarks on the scene: repairs of meshes and warnings.</summary>
        public string[] Remarks()
        {
            var remarks = new string[(int)info.RemarkCount];
            for (int i = 0; i < remarks.Length; ++i)
            {
                remarks[i] = PalpateNative.Text(PalpateNative.palpate_remark(Handle, (UIntPtr)(uint)i));
            }
            return remarks;
        }

        /// <summary>Computes the next tick, from one sample to one result per hand. Call it Info.Rate times per
        /// second. Bad samples are no errors: they latch a fault of their hand.</summary>
        public void Tick(Sample[] samples, Result[] results)
        {
            if (samples == null || results == null || samples.Length != Hands || results.Length != Hands)
            {
                throw new PalpateException(ErrorKind.Use, "Tick: needs arrays with one sample and one result per hand");
            }
            for (int hand = 0; hand < samples.Length; ++hand)
            {
                samples[hand].StructSize = SampleSize;
                results[hand].StructSize = ResultSize;
            }
            Check(PalpateNative.palpate_tick(Handle, samples, results, (UIntPtr)(uint)samples.Length));
        }

        /// <summary>Sample of a scripted device: the scene's path, or down to 12 mm and back.</summary>
        public void ScriptedSample(int hand, ulong tick, ref Sample sample)
        {
            sample.StructSize = SampleSize;
            Check(PalpateNative.palpate_scripted_sample(Handle, (uint)hand, tick, ref sample));
        }

        /// <summary>Clears latched faults at the next tick; bit 0 is the first hand.</summary>
        public void ResetFaults(uint handBits = uint.MaxValue)
        {
            Check(PalpateNative.palpate_reset_fault(Handle, handBits));
        }

        /// <summary>Back to the state before tick 0. Not while recording.</summary>
        public void Restart()
        {
            Check(PalpateNative.palpate_restart(Handle));
        }

        /// <summary>Replaces the tissue at one of the next ticks by a built-in tissue or a tissue file.</summary>
        public void SetTissue(string tissue)
        {
            Check(PalpateNative.palpate_set_tissue(Handle, PalpateNative.Utf8(tissue)));
        }

        /// <summary>Names for SetTissueValue(), as in tissue files: "k1_N_per_m", "contact.friction".</summary>
        public static string[] TissueFields()
        {
            var names = new List<string>();
            for (;;)
            {
                string name = PalpateNative.Text(PalpateNative.palpate_tissue_field((UIntPtr)(uint)names.Count));
                if (name == null) return names.ToArray();
                names.Add(name);
            }
        }

        /// <summary>Changes one number of the tissue.</summary>
        /// <param name="field">one of TissueFields()</param>
        /// <param name="value">in the unit at the end of the name ("rest_length_mm": mm)</param>
        public void SetTissueValue(string field, double value)
        {
            Check(PalpateNative.palpate_set_tissue_value(Handle, PalpateNative.Utf8(field), value));
        }

        /// <summary>One number of the tissue, in the unit at the end of its name.</summary>
        public double GetTissueValue(string field)
        {
            double value;
            Check(PalpateNative.palpate_get_tissue_value(Handle, PalpateNative.Utf8(field), out value));
            return value;
        }

        /// <summary>Switches the touch noise and sets its strength at one of the next ticks.</summary>
        /// <param name="enabled">on or off</param>
        /// <param name="gain">N m</param>
        /// <param name="threshold">m</param>
        public void SetNoise(bool enabled, double gain, double threshold)
        {
            Check(PalpateNative.palpate_set_noise(Handle, enabled ? 1 : 0, gain, threshold));
        }

        public void GetNoise(out bool enabled, out double gain, out double threshold)
        {
            int on;
            Check(PalpateNative.palpate_get_noise(Handle, out on, out gain, out threshold));
            enabled = on != 0;
        }

        /// <summary>The inclusions, visible and hidden.</summary>
        public Inclusion[] Inclusions()
        {
            var all = new Inclusion[(int)PalpateNative.palpate_inclusion_count(Handle)];
            for (int i = 0; i < all.Length; ++i)
            {
                var native = new NativeInclusion { StructSize = PalpateNative.SizeOf<NativeInclusion>() };
                Check(PalpateNative.palpate_get_inclusion(Handle, (UIntPtr)(uint)i, ref native));
                all[i] = new Inclusion
                {
                    Name = PalpateNative.Text(native.Name),
                    Position = native.Position,
                    Radius = native.Radius,
                    StiffnessRatio = native.StiffnessRatio,
                    Visible = native.Visible != 0
                };
            }
            return all;
        }

        /// <summary>Moves an inclusion and sets its stiffness ratio at one of the next ticks.</summary>
        public void SetInclusion(int index, Vec3d position, double stiffnessRatio)
        {
            var native = new NativeInclusion
            {
                StructSize = PalpateNative.SizeOf<NativeInclusion>(),
                Position = position,
                StiffnessRatio = stiffnessRatio
            };
            Check(PalpateNative.palpate_set_inclusion(Handle, (UIntPtr)(uint)index, ref native));
        }

        /// <summary>Deforms the visible surface as at the newest tick.</summary>
        public void UpdateSurface(ref Picture picture)
        {
            picture.StructSize = PalpateNative.SizeOf<Picture>();
            Check(PalpateNative.palpate_surface_update(Handle, ref picture));
        }

        /// <summary>Vertices of the last UpdateSurface(), x y z in turn [m], organ frame.</summary>
        public void CopyVertices(double[] xyz)
        {
            Check(PalpateNative.palpate_surface_vertices(Handle, xyz, Triples(xyz)));
        }

        /// <summary>Three vertex numbers per triangle, counter-clockwise from outside. They never change.</summary>
        public int[] Triangles()
        {
            var corners = new int[3 * info.Triangles];
            Check(PalpateNative.palpate_surface_triangles(Handle, corners, Triples(corners)));
            return corners;
        }

        public Part GetPart(int hand, int part)
        {
            var native = new NativePart { StructSize = PalpateNative.SizeOf<NativePart>() };
            Check(PalpateNative.palpate_tool_part(Handle, (uint)hand, (uint)part, ref native));
            return new Part
            {
                Name = PalpateNative.Text(native.Name),
                Vertices = checked((int)native.Vertices),
                Triangles = checked((int)native.Triangles),
                IsJaw = native.IsJaw != 0
            };
        }

        /// <summary>Vertices of a part, x y z in turn [m], in the handle frame with closed jaws.</summary>
        public double[] PartVertices(int hand, int part)
        {
            var xyz = new double[3 * GetPart(hand, part).Vertices];
            Check(PalpateNative.palpate_part_vertices(Handle, (uint)hand, (uint)part, xyz, Triples(xyz)));
            return xyz;
        }

        public int[] PartTriangles(int hand, int part)
        {
            var corners = new int[3 * GetPart(hand, part).Triangles];
            Check(PalpateNative.palpate_part_triangles(Handle, (uint)hand, (uint)part, corners, Triples(corners)));
            return corners;
        }

        /// <summary>Pose of a part in the handle frame.</summary>
        /// <param name="gripper">0 closed to 1 open</param>
        public void PartPose(int hand, int part, double gripper, out Vec3d position, out Quatd orientation)
        {
            Check(PalpateNative.palpate_part_pose(Handle, (uint)hand, (uint)part, gripper, out position,
                                                  out orientation));
        }

        /// <summary>Ends the recording and frees everything.</summary>
        /// <exception cref="PalpateException">the recording failed or lacks rows; all is freed even so</exception>
        public void Close()
        {
            IntPtr closing = handle;
            handle = IntPtr.Zero;
            Check(PalpateNative.palpate_close(closing));
        }

        /// <summary>As Close(), without its exception.</summary>
        public void Dispose()
        {
            IntPtr closing = handle;
            handle = IntPtr.Zero;
            PalpateNative.palpate_close(closing);
        }

        private IntPtr Handle
        {
            get
            {
                if (handle == IntPtr.Zero) throw new ObjectDisposedException("Simulation");
                return handle;
            }
        }

        private static void Check(int status)
        {
            if (status != 0)
            {
                throw new PalpateException((ErrorKind)status, PalpateNative.Text(PalpateNative.palpate_last_error()));
            }
        }

        private static UIntPtr Triples(Array numbers)
        {
            return (UIntPtr)(uint)(numbers == null ? 0 : numbers.Length / 3);
        }

        private static IntPtr Unmanaged(string text, List<IntPtr> toFree)
        {
            byte[] bytes = PalpateNative.Utf8(text);
            if (bytes == null) return IntPtr.Zero;
            IntPtr copy = Marshal.AllocHGlobal(bytes.Length);
            toFree.Add(copy);
            Marshal.Copy(bytes, 0, copy, bytes.Length);
            return copy;
        }
    }
}
