// Tests of the package without Unity: against the C interface's own values, and with the stand-in of UnityStub.cs.
// Usage: PackageTest.exe EXPECTED EXAMPLES    EXPECTED: output of reference.c and of layout.c (tools/check_unity)
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Threading;
using Palpate;
using UnityEngine;

internal static class PackageTest
{
    private static readonly Dictionary<string, string> Expected = new Dictionary<string, string>();
    private static readonly Dictionary<string, int> Layout = new Dictionary<string, int>(); // bytes, by C name
    private static string examples;

    private static int Main(string[] arguments)
    {
        CultureInfo.CurrentCulture = CultureInfo.InvariantCulture;
        foreach (string line in File.ReadAllLines(arguments[0]))
        {
            int gap = line.IndexOf(' ');
            string name = line.Substring(0, gap);
            if (name.StartsWith("palpate_")) Layout[name] = int.Parse(line.Substring(gap));
            else Expected[name] = line.Substring(gap + 1);
        }
        examples = arguments[1];
        int failures = 0, tests = 0;
        foreach (MethodInfo test in typeof(PackageTest).GetMethods(BindingFlags.Static | BindingFlags.Public))
        {
            ++tests;
            try
            {
                test.Invoke(null, null);
            }
            catch (TargetInvocationException error)
            {
                ++failures;
                Console.WriteLine("FAILED " + test.Name + ": " + error.InnerException.Message);
            }
        }
        Console.WriteLine(tests + " tests, " + failures + " failed");
        return failures == 0 ? 0 : 1;
    }

    // ---- The structs and the C interface

    public static void StructsHaveTheSizesAndOffsetsOfThoseInC()
    {
        var types = new Dictionary<string, Type>
        {
            { "palpate_options", typeof(NativeOptions) }, { "palpate_info", typeof(Info) },
            { "palpate_sample", typeof(Sample) }, { "palpate_result", typeof(Result) },
            { "palpate_inclusion", typeof(NativeInclusion) }, { "palpate_picture", typeof(Picture) },
            { "palpate_part", typeof(NativePart) }
        };
        int fields = 0;
        foreach (KeyValuePair<string, int> c in Layout)
        {
            string[] names = c.Key.Split('.');
            Type type = types[names[0]];
            if (names.Length == 1)
            {
                Equal(c.Value, Marshal.SizeOf(type), c.Key);
                continue;
            }
            ++fields;
            Equal(c.Value, (int)Marshal.OffsetOf(type, FieldOf(type, names[1])), c.Key);
        }
        Equal(79, fields, "fields in palpate.h; is the new one in Structs.cs?");
    }

    public static void AScriptedPressGivesTheBitsOfTheCInterface()
    {
        SameAsInC("press", Unheld());
    }

    public static void AScriptedPullGivesTheBitsOfTheCInterface()
    {
        SimulationOptions pull = Unheld();
        pull.Task = "pull";
        SameAsInC("pull", pull);
    }

    public static void TwoHandsGiveTheBitsOfTheCInterface()
    {
        SimulationOptions two = Unheld();
        two.SceneFile = examples + "/bimanual.toml";
        using (Simulation simulation = Simulation.Open(two)) Equal(2, simulation.Hands, "hands");
        SameAsInC("two", two);
    }

    public static void AHeldDeviceGivesTheBitsOfTheCInterface()
    {
        SameAsInC("held", new SimulationOptions { NoCache = true });
    }

    public static void ChangedTissueAndNoiseGiveTheBitsOfTheCInterface()
    {
        SameAsInC("parameters", Unheld(), (simulation, tick) =>
        {
            if (tick == 1400) simulation.SetTissue("liver");
            if (tick == 1700) simulation.SetTissueValue("rest_length_mm", 10.25);
            if (tick == 2000) simulation.SetNoise(true, 2e-5, 4e-3);
        });
        Differs("press", "parameters");
    }

    public static void AMovedAndSoftenedInclusionGivesTheBitsOfTheCInterface()
    {
        SimulationOptions options = Unheld();
        options.SceneText = "[organ]\nmesh = \"liver\"\n[tool]\nmesh = \"sphere:5\"\n" +
                            "[[organ.inclusion]]\npreset = \"nodule\"\n";
        SameAsInC("inclusion", options, (simulation, tick) =>
        {
            if (tick != 1500) return;
            Inclusion nodule = simulation.Inclusions()[0];
            Equal("nodule", nodule.Name, "name");
            nodule.Position.Z -= 0.001;
            simulation.SetInclusion(0, nodule.Position, 0.1);
            Equal(0.1, simulation.Inclusions()[0].StiffnessRatio, "ratio");
        });
    }

    public static void TissueAndNoiseCanBeRead()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            string[] fields = Simulation.TissueFields();
            True(Array.IndexOf(fields, "contact.friction") >= 0, "contact.friction is a field");
            simulation.SetTissueValue("contact.friction", 0.625);
            Equal(0.625, simulation.GetTissueValue("contact.friction"), "friction");
            simulation.SetNoise(false, 1e-5, 2e-3);
            bool enabled;
            double gain, threshold;
            simulation.GetNoise(out enabled, out gain, out threshold);
            True(!enabled && gain == 1e-5 && threshold == 2e-3, "noise");
        }
    }

    public static void AnErrorHasTheKindAndTheMessageOfTheCInterface()
    {
        SimulationOptions wrong = Unheld();
        wrong.SceneText = "[organ]\nmesh = \"gallbladder\"\nweight = 1\n";
        PalpateException error = Thrown(() => Simulation.Open(wrong));
        Equal(Expected["error"], error.Message, "message");
        Equal(ErrorKind.Input, error.Kind, "kind");
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            Contains("k1_N_per_m = -1", Thrown(() => simulation.SetTissueValue("k1_N_per_m", -1.0)).Message);
            Contains("gr\u00fcn", Thrown(() => simulation.SetTissue("gr\u00fcn")).Message); // UTF-8 both ways
            Equal(ErrorKind.Use, Thrown(() => simulation.Tick(new Sample[2], new Result[2])).Kind, "kind");
            Equal(ErrorKind.Use, Thrown(() => simulation.SetInclusion(0, new Vec3d(), 1.0)).Kind, "kind");
        }
    }

    public static void ATickAllocatesNoManagedMemory()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var samples = new Sample[1];
            var results = new Result[1];
            Ticks(simulation, samples, results, 0, 10);
            long before = GC.GetAllocatedBytesForCurrentThread();
            Ticks(simulation, samples, results, 10, 2000);
            Equal(0L, GC.GetAllocatedBytesForCurrentThread() - before, "bytes");
            True(new byte[100].Length == 100 && GC.GetAllocatedBytesForCurrentThread() > before, "the counter counts");
        }
    }

    public static void AClosedSimulationRefusesCallsAndMayBeClosedAgain()
    {
        Simulation simulation = Simulation.Open(Unheld());
        simulation.Close();
        simulation.Dispose();
        try
        {
            simulation.Restart();
        }
        catch (ObjectDisposedException)
        {
            return;
        }
        throw new Exception("Restart() worked on a closed simulation");
    }

    // ---- The loop

    public static void TheLoopsThreadGivesTheRowsOfTicksWithoutIt()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var device = new WatchedDevice(simulation);
            RunLoop(simulation, device, 2500, new FakeClock());
            Equal(Expected["press"], device.Hash.ToString(), "hash");
            Equal(2500, device.Writes, "writes");
            True(device.Stops > 0, "stopped at the end");
            Equal(0L, device.Allocated, "bytes that 2,000 ticks of the loop allocate");
        }
    }

    public static void TheLoopKeepsTheScenesRate()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var clock = new FakeClock();
            RunLoop(simulation, new WatchedDevice(simulation), 1001, clock);
            Equal(FakeClock.Start + (long)(1000 * FakeClock.PerSecond / simulation.Info.Rate), clock.Now, "time");
        }
    }

    public static void TheNewestResultsAreThereForThePicture()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var newest = new Result[1];
            using (var loop = new HapticLoop(simulation, new IHapticDevice[] { new WatchedDevice(simulation) }, 100,
                                             new FakeClock()))
            {
                loop.CopyResults(newest);
                Equal(0.0, newest[0].Time, "time before the start");
                loop.Start();
                True(loop.Wait(60000), "the loop ends");
                loop.CopyResults(newest);
                Equal(99UL, newest[0].Tick, "tick");
            }
        }
    }

    public static void AStallOfAHeldDeviceIsAFaultAndZeroForceUntilItIsReset()
    {
        using (Simulation simulation = Simulation.Open(new SimulationOptions { NoCache = true }))
        {
            var clock = new FakeClock();
            var device = new WatchedDevice(simulation) { StallAt = 3000, Clock = clock };
            HapticLoop loop = RunLoop(simulation, device, 3200, clock);
            True(device.ForceBeforeStall > 0.1, "force before the stall");
            True(device.StoppedWhileStuck, "the watchdog stops a device whose loop is stuck");
            Equal(1, loop.WatchdogStops, "watchdog stops");
            Equal(1, loop.Stalls, "stalls");
            Equal(0.0, device.LargestForceAfterStall, "largest force after the stall");
            var newest = new Result[1];
            loop.CopyResults(newest);
            Equal(Fault.StalledLoop, newest[0].Fault, "fault");
            Contains("stood still", Simulation.Describe(newest[0].Fault));
        }
    }

    public static void WithoutAHeldDeviceAStallIsALateTick()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var clock = new FakeClock();
            var device = new WatchedDevice(simulation) { JumpAt = 100, Clock = clock };
            HapticLoop loop = RunLoop(simulation, device, 200, clock);
            Equal(1, loop.Stalls, "stalls");
            Equal(0, loop.WatchdogStops, "watchdog stops");
            Equal(200, device.Writes, "writes");
        }
    }

    public static void ADeviceThatRefusesACommandHasAFault()
    {
        using (Simulation simulation = Simulation.Open(new SimulationOptions { NoCache = true }))
        {
            HapticLoop loop = RunLoop(simulation, new WatchedDevice(simulation) { RefuseAt = 50 }, 100, new FakeClock());
            var newest = new Result[1];
            loop.CopyResults(newest);
            Equal(Fault.Device, newest[0].Fault, "fault");
        }
    }

    public static void AnExceptionOfADeviceEndsTheLoopAndStopsTheDevices()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var device = new WatchedDevice(simulation) { ThrowAt = 50 };
            HapticLoop loop = RunLoop(simulation, device, 100, new FakeClock());
            Equal("unplugged", loop.Failure.Message, "failure");
            True(device.Stops > 0 && !loop.Running, "stopped");
        }
    }

    public static void TheRealClockEndsWithItsTicks()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var device = new WatchedDevice(simulation);
            RunLoop(simulation, device, 50, null);
            Equal(50, device.Writes, "writes");
        }
    }

    public static void APointerDeviceReachesItsTargetWithoutAJump()
    {
        using (Simulation simulation = Simulation.Open(Unheld()))
        {
            var device = new PointerDevice(simulation, 0);
            Vec3d target = device.Target;
            target.Z -= 0.020;
            device.SetTarget(target, 0.25);
            var samples = new Sample[1];
            var results = new Result[1];
            ResultStatus seen = ResultStatus.None;
            for (ulong tick = 0; tick < 1000; ++tick)
            {
                device.Read(tick, 1e-3 * tick, ref samples[0]);
                simulation.Tick(samples, results);
                seen |= results[0].Status;
            }
            True(Math.Abs(samples[0].Position.Z - target.Z) < 1e-6, "the target is reached");
            True(Math.Abs(samples[0].Gripper - 0.25) < 1e-6, "the gripper's target is reached");
            True((seen & ResultStatus.Jump) == 0, "no jump");
            True(results[0].TissueForce > 0.1, "the organ is pressed");
        }
    }

    // ---- Unity's frame and the components

    public static void TheFrameSwapsYAndZAndKeepsRotations()
    {
        Vector3 v = UnityFrame.Vector(new Vec3d(1, 2, 3));
        True(v.x == 1 && v.y == 3 && v.z == 2, "vector");
        Vec3d back = UnityFrame.Vector(v);
        True(back.X == 1 && back.Y == 2 && back.Z == 3, "vector and back");
        // A quarter turn about Palpate's x takes y to z; in Unity z to y.
        double half = Math.Sqrt(0.5);
        Near(new Vector3(0, 1, 0), UnityFrame.Rotation(new Quatd(half, half, 0, 0)) * new Vector3(0, 0, 1));
        // About Palpate's y: z to x; in Unity y to x.
        Near(new Vector3(1, 0, 0), UnityFrame.Rotation(new Quatd(half, 0, half, 0)) * new Vector3(0, 1, 0));
        // About Palpate's z: x to y; in Unity x to z.
        Near(new Vector3(0, 0, 1), UnityFrame.Rotation(new Quatd(half, 0, 0, half)) * new Vector3(1, 0, 0));
        // A torque r x F = (0, 0, 1) from r = x, F = y; in Unity's frame cross(x, z) = -y.
        Near(new Vector3(0, -1, 0), UnityFrame.Axial(new Vec3d(0, 0, 1)));
    }

    public static void TheComponentShowsTheDeformedSurfaceWithUnitysWinding()
    {
        var holder = new GameObject("Palpate");
        var organ = holder.AddComponent<PalpateOrgan>();
        Call(organ, "OnEnable");
        Mesh shown = holder.transform.children[0].gameObject.GetComponent<MeshFilter>().sharedMesh;
        Vector3[] rest = shown.vertices;
        double volume = 0.0;
        for (int i = 0; i < shown.triangles.Length; i += 3)
        {
            Vector3 a = rest[shown.triangles[i]], b = rest[shown.triangles[i + 1]], c = rest[shown.triangles[i + 2]];
            volume += (a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x)) / 6;
        }
        double pressed = Number("volume");
        True(volume > 0.95 * pressed && volume < 1.05 * pressed, "clockwise faces, volume " + volume);
        True(Until(() => organ.Results[0].Depth > 0.005, organ), "the scripted tool presses");
        double largest = 0.0;
        Vector3[] now = shown.vertices;
        for (int i = 0; i < now.Length; ++i) largest = Math.Max(largest, rest[i].y - now[i].y);
        True(largest > 0.003, "the surface is dented along Unity's y, by " + largest);
        Transform tool = holder.transform.children[1];
        True(tool.children.Count == organ.Simulation.Info.ToolParts(0), "parts of the tool");
        Call(organ, "OnDisable");
        True(organ.Simulation == null && organ.Loop == null, "closed");
    }

    public static void TheComponentAppliesTissueAndNoiseAndReportsBadOnes()
    {
        var organ = new GameObject("Palpate").AddComponent<PalpateOrgan>();
        Call(organ, "OnEnable");
        Equal(5e-5, organ.noiseGain, "gain of the scene");
        organ.tissue = "heart";
        organ.noiseGain = 1e-5;
        Call(organ, "Update");
        bool enabled;
        double gain, threshold;
        organ.Simulation.GetNoise(out enabled, out gain, out threshold);
        Equal(1e-5, gain, "gain");
        Debug.last = "";
        organ.tissue = "granite";
        Call(organ, "Update");
        Contains("granite", Debug.last);
        Debug.last = "";
        Call(organ, "Update");
        Equal("", Debug.last, "reported once");
        Call(organ, "OnDisable");
        organ.task = "cut";
        Call(organ, "OnEnable");
        Contains("cut", Debug.last);
        True(!organ.enabled && organ.Simulation == null, "disabled");
    }

    public static void TheMouseMovesTheToolDown()
    {
        var holder = new GameObject("Palpate");
        var organ = holder.AddComponent<PalpateOrgan>();
        var mouse = holder.AddComponent<MouseHand>();
        organ.devices = new HapticDeviceBehaviour[] { mouse };
        Call(organ, "OnEnable");
        Transform tool = holder.transform.children[1];
        True(Until(() => organ.Results[0].Tick > 0, organ), "the loop runs");
        float before = tool.localPosition.y;
        Input.mouseY = -5.0f;
        Call(mouse, "Update"); // 5 mm
        Input.mouseY = 0.0f;
        True(Until(() => Math.Abs(before - tool.localPosition.y - 0.005f) < 1e-5f, organ), "5 mm down");
        Call(organ, "OnDisable");
    }

    public static void TheSampleSceneMakesAnOrganAndAMouseHand()
    {
        var scene = new GameObject("scene").AddComponent<Palpate.Samples.PressScene>();
        Call(scene, "Start");
        Call(scene, "Update");
        Call(scene, "OnGUI");
    }

    // ---- Helpers

    private static SimulationOptions Unheld()
    {
        return new SimulationOptions { NoHand = true, NoCache = true };
    }

    private static void Ticks(Simulation simulation, Sample[] samples, Result[] results, ulong first, ulong last)
    {
        for (ulong tick = first; tick < last; ++tick)
        {
            for (int hand = 0; hand < samples.Length; ++hand) simulation.ScriptedSample(hand, tick, ref samples[hand]);
            simulation.Tick(samples, results);
        }
    }

    private static void SameAsInC(string name, SimulationOptions options, Action<Simulation, ulong> change = null)
    {
        using (Simulation simulation = Simulation.Open(options))
        {
            var samples = new Sample[simulation.Hands];
            var results = new Result[simulation.Hands];
            var hash = new Fnv();
            for (ulong tick = 0; tick < 2500; ++tick)
            {
                if (change != null) change(simulation, tick);
                Ticks(simulation, samples, results, tick, tick + 1);
                foreach (Result result in results) hash.Add(result);
            }
            Equal(Number(name + "_depth"), results[0].Depth, "depth");
            Equal(Number(name + "_force"), results[0].TissueForce, "tissue force");
            Equal(Expected[name], hash.ToString(), "hash of all results");
            True(results[0].Depth > 0.001, "the tool is in the organ");
            if (name == "press") SurfaceAsInC(simulation);
        }
    }

    private static void SurfaceAsInC(Simulation simulation)
    {
        var picture = new Picture();
        simulation.UpdateSurface(ref picture);
        var xyz = new double[3 * simulation.Info.Vertices];
        simulation.CopyVertices(xyz);
        var hash = new Fnv();
        foreach (double number in xyz) hash.Add(BitConverter.GetBytes(number));
        Equal(Expected["vertices"], hash.ToString(), "hash of the vertices");
        Equal(Number("tool_z"), picture.ToolPosition(0).Z, "tool's z");
        Equal(2499UL, picture.Tick, "tick");
    }

    private static HapticLoop RunLoop(Simulation simulation, IHapticDevice device, ulong ticks, LoopClock clock)
    {
        var loop = new HapticLoop(simulation, new[] { device }, ticks, clock);
        loop.Start();
        bool ended = loop.Wait(60000);
        loop.Dispose();
        True(ended, "the loop ends within a minute");
        return loop;
    }

    /// <summary>Updates the component until the condition holds, for at most a minute.</summary>
    private static bool Until(Func<bool> condition, PalpateOrgan organ)
    {
        for (int i = 0; i < 6000; ++i)
        {
            Call(organ, "Update");
            if (condition()) return true;
            Thread.Sleep(10);
        }
        return false;
    }

    /// <summary>Calls a private message method, as Unity does.</summary>
    private static void Call(object behaviour, string message)
    {
        MethodInfo method = behaviour.GetType().GetMethod(message, BindingFlags.Instance | BindingFlags.NonPublic);
        method.Invoke(behaviour, null);
    }

    /// <summary>The C# field of a C field: "tool_position" is ToolPosition or ToolPosition0.</summary>
    private static string FieldOf(Type type, string name)
    {
        string plain = name.Replace("_", "");
        foreach (FieldInfo field in type.GetFields(BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic))
        {
            string own = field.Name.ToLowerInvariant();
            if (own == plain || own == plain + "0" || own == plain.Replace("vertices", "vertex").TrimEnd('s') + "count")
            {
                return field.Name;
            }
        }
        throw new Exception(type.Name + " lacks the field " + name);
    }

    private static double Number(string name)
    {
        return double.Parse(Expected[name], CultureInfo.InvariantCulture);
    }

    private static PalpateException Thrown(Action call)
    {
        try
        {
            call();
        }
        catch (PalpateException error)
        {
            return error;
        }
        throw new Exception("no PalpateException");
    }

    private static void True(bool condition, string claim)
    {
        if (!condition) throw new Exception("not true: " + claim);
    }

    private static void Equal<T>(T expected, T found, string what)
    {
        if (!expected.Equals(found)) throw new Exception(what + ": expected " + expected + ", found " + found);
    }

    private static void Differs(string one, string other)
    {
        True(Expected[one] != Expected[other], one + " and " + other + " differ");
    }

    private static void Contains(string part, string text)
    {
        True(text.Contains(part), "\"" + text + "\" contains \"" + part + "\"");
    }

    private static void Near(Vector3 expected, Vector3 found)
    {
        double off = Math.Abs(expected.x - found.x) + Math.Abs(expected.y - found.y) + Math.Abs(expected.z - found.z);
        True(off < 1e-6, "expected " + expected.x + " " + expected.y + " " + expected.z + ", found " + found.x + " " +
                             found.y + " " + found.z);
    }

    /// <summary>FNV-1a, 64 bits, as in reference.c. Add(Result) allocates nothing.</summary>
    private sealed class Fnv
    {
        private readonly Result[] one = new Result[1];
        private readonly byte[] bytes = new byte[Marshal.SizeOf(typeof(Result))];
        private readonly IntPtr pinned;
        private ulong value = 14695981039346656037;

        public Fnv()
        {
            pinned = GCHandle.Alloc(one, GCHandleType.Pinned).AddrOfPinnedObject(); // until the test ends
        }

        public void Add(Result result)
        {
            one[0] = result;
            Marshal.Copy(pinned, bytes, 0, bytes.Length);
            Add(bytes);
        }

        public void Add(byte[] data)
        {
            foreach (byte part in data) value = unchecked((value ^ part) * 1099511628211);
        }

        public override string ToString()
        {
            return value.ToString("x16");
        }
    }

    /// <summary>A clock that moves only when the loop waits.</summary>
    private sealed class FakeClock : LoopClock
    {
        public const long PerSecond = 1000000, Start = 5000000;
        private long now = Start;

        public override long Frequency { get { return PerSecond; } }

        public override long Now { get { return Volatile.Read(ref now); } }

        public override void WaitUntil(long due)
        {
            if (due > Now) Volatile.Write(ref now, due);
        }

        public void Advance(long by)
        {
            Volatile.Write(ref now, now + by);
        }
    }

    /// <summary>A scripted device that counts, and fails as a test wants.</summary>
    private sealed class WatchedDevice : IHapticDevice
    {
        private const ulong Never = ulong.MaxValue;
        public readonly Fnv Hash = new Fnv();
        public ulong StallAt = Never, JumpAt = Never, RefuseAt = Never, ThrowAt = Never;
        public FakeClock Clock;
        public int Writes, Stops;
        public long Allocated;
        public bool StoppedWhileStuck;
        public double ForceBeforeStall, LargestForceAfterStall;
        private readonly ManualResetEvent stop = new ManualResetEvent(false);
        private readonly Simulation simulation;
        private ulong at;
        private long before;

        public WatchedDevice(Simulation simulation)
        {
            this.simulation = simulation;
        }

        public void Read(ulong tick, double time, ref Sample sample)
        {
            at = tick;
            if (tick == 100) before = GC.GetAllocatedBytesForCurrentThread();
            if (tick == 2100) Allocated = GC.GetAllocatedBytesForCurrentThread() - before;
            if (tick == ThrowAt) throw new InvalidOperationException("unplugged");
            if (tick == JumpAt || tick == StallAt) Clock.Advance(FakeClock.PerSecond);
            if (tick == StallAt) StoppedWhileStuck = stop.WaitOne(60000);
            simulation.ScriptedSample(0, tick, ref sample);
        }

        public bool Write(ref Result result)
        {
            ++Writes;
            Hash.Add(result);
            if (at < StallAt) ForceBeforeStall = result.DeviceForce.Length;
            else LargestForceAfterStall = Math.Max(LargestForceAfterStall, result.DeviceForce.Length);
            return at != RefuseAt;
        }

        public void Stop()
        {
            Interlocked.Increment(ref Stops);
            stop.Set();
        }
    }
}
