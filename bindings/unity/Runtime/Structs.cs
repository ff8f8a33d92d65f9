// The structs of palpate.h. All are blittable: fields have the order and size of the C fields.
using System;
using System.Runtime.InteropServices;

namespace Palpate
{
    /// <summary>Three numbers, in Palpate's right-handed frame with z up.</summary>
    [Serializable]
    [StructLayout(LayoutKind.Sequential)]
    public struct Vec3d
    {
        public double X, Y, Z;

        public Vec3d(double x, double y, double z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        public double Length { get { return Math.Sqrt(X * X + Y * Y + Z * Z); } }
    }

    /// <summary>A rotation as a unit quaternion.</summary>
    [Serializable]
    [StructLayout(LayoutKind.Sequential)]
    public struct Quatd
    {
        public double W, X, Y, Z;

        public Quatd(double w, double x, double y, double z)
        {
            W = w;
            X = x;
            Y = y;
            Z = z;
        }
    }

    /// <summary>Cause of a hand's zero force. A fault latches until Simulation.ResetFaults().</summary>
    public enum Fault : uint
    {
        None = 0,
        NotFinite = 1,
        Device = 2,
        StaleSample = 3,
        StalledLoop = 4,
        ForceOff = 5,
        Unstable = 6
    }

    public enum Phase : uint
    {
        Approach = 0,
        Press = 1,
        Pull = 2,
        /// <summary>A needle in the tissue.</summary>
        Insert = 3
    }

    /// <summary>Bits of Result.Status.</summary>
    [Flags]
    public enum ResultStatus : uint
    {
        None = 0,
        /// <summary>No force until the tool has been outside the organ.</summary>
        StartedInside = 1u << 0,
        /// <summary>A part of the tool has more than four contacts.</summary>
        ContactsFull = 1u << 1,
        /// <summary>The force exceeded the grip limit, and the grasp let go.</summary>
        GripReleased = 1u << 2,
        /// <summary>The tool moved faster than any hand, and the contacts were reset.</summary>
        Jump = 1u << 3,
        /// <summary>Deeper than the tissue's source.max_depth_mm.</summary>
        Extrapolated = 1u << 4,
        /// <summary>A needle is in up to its hub, which pushes the tissue.</summary>
        AtHub = 1u << 5,
        ForceClamped = 1u << 8,
        ForceSlewed = 1u << 9,
        TorqueClamped = 1u << 10,
        TorqueSlewed = 1u << 11,
        /// <summary>The passivity controller acted.</summary>
        EnergyDamped = 1u << 12,
        DutyHigh = 1u << 13,
        DutyLimited = 1u << 14
    }

    /// <summary>Description of a loaded scene.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Info
    {
        internal UIntPtr StructSize;
        /// <summary>1 to 4.</summary>
        public uint Hands;
        /// <summary>One bit per hand: a hand holds its device.</summary>
        public uint Held;
        /// <summary>Hz, ticks per second that the loop must keep.</summary>
        public double Rate;
        /// <summary>N, largest force of a result.</summary>
        public double MaxForce;
        /// <summary>N m.</summary>
        public double MaxTorque;
        public ulong Seed;
        /// <summary>Number of ticks with a scripted motion.</summary>
        public ulong ScriptedTicks;
        internal UIntPtr VertexCount;
        internal UIntPtr TriangleCount;
        internal UIntPtr RemarkCount;
        internal uint ToolParts0, ToolParts1, ToolParts2, ToolParts3;

        public int Vertices { get { return checked((int)VertexCount); } }
        public int Triangles { get { return checked((int)TriangleCount); } }

        /// <summary>Number of rigid parts of a hand's instrument.</summary>
        public int ToolParts(int hand)
        {
            switch (hand)
            {
                case 0: return (int)ToolParts0;
                case 1: return (int)ToolParts1;
                case 2: return (int)ToolParts2;
                case 3: return (int)ToolParts3;
                default: throw new ArgumentOutOfRangeException("hand");
            }
        }
    }

    /// <summary>One sample of one device, in the device frame.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Sample
    {
        internal UIntPtr StructSize;
        /// <summary>m.</summary>
        public Vec3d Position;
        /// <summary>A unit quaternion.</summary>
        public Quatd Orientation;
        /// <summary>m/s.</summary>
        public Vec3d Velocity;
        /// <summary>0 closed to 1 open.</summary>
        public double Gripper;
        /// <summary>s since the device took the sample; more than 5 ms is a fault.</summary>
        public double Age;
        /// <summary>One bit per button.</summary>
        public uint Buttons;
        /// <summary>A sample with a fault needs no pose.</summary>
        public Fault Fault;
    }

    /// <summary>Result of one hand at one tick.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Result
    {
        internal UIntPtr StructSize;
        public ulong Tick;
        /// <summary>s, tick / rate.</summary>
        public double Time;
        /// <summary>N, on the hand, in the device frame. Write it to the device unchanged.</summary>
        public Vec3d DeviceForce;
        /// <summary>N m, about the handle's origin, in the device frame.</summary>
        public Vec3d DeviceTorque;
        /// <summary>N.</summary>
        public double GripperForce;
        /// <summary>N, in the world frame, as all that follows.</summary>
        public Vec3d Force;
        /// <summary>N m.</summary>
        public Vec3d Torque;
        /// <summary>N, norm before the gate.</summary>
        public double TissueForce;
        /// <summary>N, signed along the normal.</summary>
        public double NoiseForce;
        /// <summary>N.</summary>
        public double Friction;
        /// <summary>m, from tool to organ, negative inside.</summary>
        public double Distance;
        /// <summary>m, penetration depth of the contact with the largest force.</summary>
        public double Depth;
        /// <summary>m, on the rest surface; without contact the nearest point.</summary>
        public Vec3d Contact;
        public Vec3d Normal;
        /// <summary>m, of the handle.</summary>
        public Vec3d ToolPosition;
        public Quatd ToolOrientation;
        /// <summary>0 closed to 1 open.</summary>
        public double Gripper;
        /// <summary>J, work on the tissue force that was not returned; outside the tissue a surplus is reset to 0.</summary>
        public double Energy;
        /// <summary>Gain of force and noise (force ramp), 0 to 1.</summary>
        public double Engagement;
        public Phase Phase;
        /// <summary>Layer of the layered law; 0 without contact.</summary>
        public uint CutoffLayer;
        /// <summary>1: past the last layer, where the force stays constant.</summary>
        public uint Saturated;
        public ResultStatus Status;
        /// <summary>Latched.</summary>
        public Fault Fault;
        /// <summary>Of the tissue at a needle's tip, from 1; 0: in none.</summary>
        public uint Layer;
    }

    /// <summary>Poses at the tick of the surface, in the world frame.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Picture
    {
        internal UIntPtr StructSize;
        public ulong Tick;
        /// <summary>m.</summary>
        public Vec3d OrganPosition;
        public Quatd OrganOrientation;
        internal Vec3d ToolPosition0, ToolPosition1, ToolPosition2, ToolPosition3;
        internal Quatd ToolOrientation0, ToolOrientation1, ToolOrientation2, ToolOrientation3;
        internal double Gripper0, Gripper1, Gripper2, Gripper3;

        /// <summary>m, of a hand's handle.</summary>
        public Vec3d ToolPosition(int hand)
        {
            return hand == 0 ? ToolPosition0 : hand == 1 ? ToolPosition1 : hand == 2 ? ToolPosition2 : ToolPosition3;
        }

        public Quatd ToolOrientation(int hand)
        {
            return hand == 0 ? ToolOrientation0
                : hand == 1 ? ToolOrientation1
                : hand == 2 ? ToolOrientation2 : ToolOrientation3;
        }

        /// <summary>0 closed to 1 open.</summary>
        public double Gripper(int hand)
        {
            return hand == 0 ? Gripper0 : hand == 1 ? Gripper1 : hand == 2 ? Gripper2 : Gripper3;
        }
    }

    [StructLayout(LayoutKind.Sequential)]
    internal struct NativeOptions
    {
        public UIntPtr StructSize;
        public IntPtr SceneFile, SceneText, SceneFolder, Task, RecordFile;
        public int RecordWaits, NoHand, NoCache, Reserved;
        public double SurfaceEdge;
        public IntPtr Progress, ProgressUser;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal struct NativeInclusion
    {
        public UIntPtr StructSize;
        public Vec3d Position;
        public double Radius, StiffnessRatio;
        public IntPtr Name;
        public int Visible, Reserved;
    }

    [StructLayout(LayoutKind.Sequential)]
    internal struct NativePart
    {
        public UIntPtr StructSize;
        public IntPtr Name;
        public UIntPtr Vertices, Triangles;
        public int IsJaw, Reserved;
    }
}
