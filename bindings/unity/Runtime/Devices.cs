using System;
using System.Threading;

namespace Palpate
{
    /// <summary>One haptic device. The haptic loop calls Read() and Write() every tick, so they must not allocate,
    /// wait or log.</summary>
    public interface IHapticDevice
    {
        /// <summary>Writes the device's newest sample; for a device that cannot be read, Sample.Fault.</summary>
        /// <param name="tick">number of the tick, from 0</param>
        /// <param name="time">s, tick / rate</param>
        /// <param name="sample">zero, or as of the last tick; Fault is None</param>
        void Read(ulong tick, double time, ref Sample sample);

        /// <summary>Commands DeviceForce, DeviceTorque and GripperForce.</summary>
        /// <returns>false if the device refused: its hand then has Fault.Device</returns>
        bool Write(ref Result result);

        /// <summary>Commands zero force. The watchdog also calls it, on its own thread, while Read() or Write()
        /// may be stuck.</summary>
        void Stop();
    }

    /// <summary>Follows the scene's path, or moves to 12 mm of depth and back. It feels no force.</summary>
    public sealed class ScriptedDevice : IHapticDevice
    {
        private readonly Simulation simulation;
        private readonly int hand;

        public ScriptedDevice(Simulation simulation, int hand)
        {
            this.simulation = simulation;
            this.hand = hand;
        }

        public void Read(ulong tick, double time, ref Sample sample)
        {
            simulation.ScriptedSample(hand, tick, ref sample);
        }

        public bool Write(ref Result result)
        {
            return true;
        }

        public void Stop()
        {
        }
    }

    /// <summary>A tool that follows a target set from another thread, such as a mouse. It feels no force. A low-pass
    /// filter turns the steps of 60 frames per second into a smooth motion.</summary>
    public sealed class PointerDevice : IHapticDevice
    {
        private const double TimeConstant = 0.03; // s
        private const double MaxSpeed = 0.5; // m/s

        private readonly double period;
        private Sample at;
        private double x, y, z, gripper; // the target

        /// <param name="simulation">gives the first pose, that of the scripted device</param>
        /// <param name="hand">from 0</param>
        public PointerDevice(Simulation simulation, int hand)
        {
            period = 1.0 / simulation.Info.Rate;
            simulation.ScriptedSample(hand, 0, ref at);
            at.Velocity = new Vec3d();
            SetTarget(at.Position, at.Gripper);
        }

        /// <summary>m, in the device frame.</summary>
        public Vec3d Target
        {
            get { return new Vec3d(Volatile.Read(ref x), Volatile.Read(ref y), Volatile.Read(ref z)); }
        }

        /// <param name="position">m, in the device frame</param>
        /// <param name="grip">0 closed to 1 open</param>
        public void SetTarget(Vec3d position, double grip)
        {
            Volatile.Write(ref x, position.X);
            Volatile.Write(ref y, position.Y);
            Volatile.Write(ref z, position.Z);
            Volatile.Write(ref gripper, Math.Min(Math.Max(grip, 0.0), 1.0));
        }

        public void Read(ulong tick, double time, ref Sample sample)
        {
            Vec3d target = Target;
            var v = new Vec3d((target.X - at.Position.X) / TimeConstant, (target.Y - at.Position.Y) / TimeConstant,
                              (target.Z - at.Position.Z) / TimeConstant);
            double slower = Math.Min(1.0, MaxSpeed / Math.Max(v.Length, 1e-9));
            at.Velocity = new Vec3d(slower * v.X, slower * v.Y, slower * v.Z);
            at.Position = new Vec3d(at.Position.X + period * at.Velocity.X, at.Position.Y + period * at.Velocity.Y,
                                    at.Position.Z + period * at.Velocity.Z);
            at.Gripper += (Volatile.Read(ref gripper) - at.Gripper) * period / TimeConstant;
            sample = at;
        }

        public bool Write(ref Result result)
        {
            return true;
        }

        public void Stop()
        {
        }
    }
}
