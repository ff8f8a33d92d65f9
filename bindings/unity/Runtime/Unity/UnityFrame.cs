#if UNITY_5_3_OR_NEWER
using UnityEngine;

namespace Palpate
{
    /// <summary>
    /// From Palpate's frame (right-handed, z up) to Unity's (left-handed, y up): y and z change places. A metre stays
    /// one unit; scale the game object to see an organ larger.
    /// </summary>
    public static class UnityFrame
    {
        /// <summary>A position, force or velocity.</summary>
        public static Vector3 Vector(Vec3d v)
        {
            return new Vector3((float)v.X, (float)v.Z, (float)v.Y);
        }

        /// <summary>A vector of Unity in Palpate's frame.</summary>
        public static Vec3d Vector(Vector3 v)
        {
            return new Vec3d(v.x, v.z, v.y);
        }

        /// <summary>A torque or angular velocity, whose sense turns with the handedness.</summary>
        public static Vector3 Axial(Vec3d v)
        {
            return -Vector(v);
        }

        public static Quaternion Rotation(Quatd q)
        {
            return new Quaternion(-(float)q.X, -(float)q.Z, -(float)q.Y, (float)q.W);
        }

        /// <summary>x y z in turn to vertices of a Mesh.</summary>
        public static void Vertices(double[] xyz, Vector3[] vertices)
        {
            for (int i = 0; i < vertices.Length; ++i)
            {
                vertices[i] = new Vector3((float)xyz[3 * i], (float)xyz[3 * i + 2], (float)xyz[3 * i + 1]);
            }
        }

        /// <summary>Flips the winding, in place: counter-clockwise in Palpate, clockwise in Unity.</summary>
        public static int[] Triangles(int[] corners)
        {
            for (int i = 0; i + 2 < corners.Length; i += 3)
            {
                int second = corners[i + 1];
                corners[i + 1] = corners[i + 2];
                corners[i + 2] = second;
            }
            return corners;
        }
    }
}
#endif
